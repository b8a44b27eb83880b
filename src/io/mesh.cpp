// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "base/bytes.hpp"
#include "curlidar/io.hpp"

namespace curlidar {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

ByteSpan bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// What a mesh file holds; normals are of the vertices, or empty.
struct MeshView {
  std::span<const Vec3> vertices;
  std::span<const Triangle> triangles;
  std::span<const Vec3> normals;
};

void add_line(std::string& text, const char* start, const Vec3& v) {
  text += fmt::format("{}{} {} {}", start, static_cast<float>(v.x), static_cast<float>(v.y),
                      static_cast<float>(v.z));
}

std::string obj_text(const MeshView& mesh) {
  std::string text;
  for (const Vec3& v : mesh.vertices) {
    add_line(text, "v ", v);
    text += '\n';
  }
  for (const Vec3& n : mesh.normals) {
    add_line(text, "vn ", n);
    text += '\n';
  }
  for (const Triangle& t : mesh.triangles) {
    text += 'f';
    for (const std::uint32_t corner : t) {  // OBJ counts from 1
      const std::uint64_t number = std::uint64_t{corner} + 1;
      text += mesh.normals.empty() ? fmt::format(" {}", number)
                                   : fmt::format(" {}//{}", number, number);
    }
    text += '\n';
  }
  return text;
}

std::string ply_header(const char* format, const MeshView& mesh) {
  const char* normals =
      mesh.normals.empty() ? "" : "property float nx\nproperty float ny\nproperty float nz\n";
  return fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\n{}element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      format, mesh.vertices.size(), normals, mesh.triangles.size());
}

std::string ply_text(const MeshView& mesh) {
  std::string text = ply_header("ascii", mesh);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    add_line(text, "", mesh.vertices[i]);
    if (!mesh.normals.empty()) add_line(text, " ", mesh.normals[i]);
    text += '\n';
  }
  for (const Triangle& t : mesh.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

void write_vector(ByteWriter& writer, const Vec3& v) {
  writer.write(static_cast<float>(v.x));
  writer.write(static_cast<float>(v.y));
  writer.write(static_cast<float>(v.z));
}

std::vector<std::byte> ply_binary(const MeshView& mesh) {
  const std::string header = ply_header("binary_little_endian", mesh);
  ByteWriter writer;
  writer.write_bytes(bytes_of(header));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    write_vector(writer, mesh.vertices[i]);
    if (!mesh.normals.empty()) write_vector(writer, mesh.normals[i]);
  }
  for (const Triangle& t : mesh.triangles) {
    writer.write(std::uint8_t{3});
    for (const std::uint32_t corner : t) writer.write(corner);
  }
  return std::move(writer).bytes();
}

}  // namespace

std::optional<MeshFormat> mesh_format_by_extension(std::string_view path) {
  constexpr std::size_t kLength = 4;
  if (path.size() < kLength) return std::nullopt;
  std::string end(path.substr(path.size() - kLength));
  std::transform(end.begin(), end.end(), end.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (end == ".ply") return MeshFormat::ply;
  if (end == ".obj") return MeshFormat::obj;
  return std::nullopt;
}

Status write_mesh(const std::string& path, std::span<const Vec3> vertices,
                  std::span<const Triangle> triangles, Encoding encoding,
                  std::span<const Vec3> normals, std::optional<MeshFormat> format) {
  if (!normals.empty() && normals.size() != vertices.size()) {
    return Error{ErrorCode::invalid_argument, fmt::format("{}: {} normals for {} vertices", path,
                                                          normals.size(), vertices.size())};
  }
  const MeshView mesh{vertices, triangles, normals};
  if (!format) format = mesh_format_by_extension(path);
  if (format == MeshFormat::obj) return write_file(path, bytes_of(obj_text(mesh)));
  if (encoding == Encoding::ascii) return write_file(path, bytes_of(ply_text(mesh)));
  if (encoding == Encoding::binary) return write_file(path, ply_binary(mesh));
  return Error{ErrorCode::unsupported,
               fmt::format("{}: meshes are written in ascii or binary encoding", path)};
}

}  // namespace curlidar
