// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <iterator>

#include "base/bytes.hpp"
#include "curlidar/io.hpp"

namespace curlidar {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

ByteSpan bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string obj_text(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  std::string text;
  auto out = std::back_inserter(text);
  for (const Vec3& v : vertices) {
    fmt::format_to(out, "v {} {} {}\n", static_cast<float>(v.x), static_cast<float>(v.y),
                   static_cast<float>(v.z));
  }
  for (const Triangle& t : triangles) {  // OBJ counts from 1
    fmt::format_to(out, "f {} {} {}\n", std::uint64_t{t[0]} + 1, std::uint64_t{t[1]} + 1,
                   std::uint64_t{t[2]} + 1);
  }
  return text;
}

std::string ply_header(const char* format, std::size_t vertices, std::size_t triangles) {
  return fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      format, vertices, triangles);
}

std::string ply_text(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  std::string text = ply_header("ascii", vertices.size(), triangles.size());
  auto out = std::back_inserter(text);
  for (const Vec3& v : vertices) {
    fmt::format_to(out, "{} {} {}\n", static_cast<float>(v.x), static_cast<float>(v.y),
                   static_cast<float>(v.z));
  }
  for (const Triangle& t : triangles) fmt::format_to(out, "3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

std::vector<std::byte> ply_binary(std::span<const Vec3> vertices,
                                  std::span<const Triangle> triangles) {
  const std::string header = ply_header("binary_little_endian", vertices.size(), triangles.size());
  ByteWriter writer;
  writer.write_bytes(bytes_of(header));
  for (const Vec3& v : vertices) {
    writer.write(static_cast<float>(v.x));
    writer.write(static_cast<float>(v.y));
    writer.write(static_cast<float>(v.z));
  }
  for (const Triangle& t : triangles) {
    writer.write(std::uint8_t{3});
    for (const std::uint32_t corner : t) writer.write(corner);
  }
  return std::move(writer).bytes();
}

}  // namespace

Status write_mesh(const std::string& path, std::span<const Vec3> vertices,
                  std::span<const Triangle> triangles, Encoding encoding) {
  if (path.ends_with(".obj")) {
    return write_file(path, bytes_of(obj_text(vertices, triangles)));
  }
  if (encoding == Encoding::ascii) {
    return write_file(path, bytes_of(ply_text(vertices, triangles)));
  }
  if (encoding == Encoding::binary) return write_file(path, ply_binary(vertices, triangles));
  return Error{ErrorCode::unsupported,
               fmt::format("{}: meshes are written in ascii or binary encoding", path)};
}

}  // namespace curlidar
