// SPDX-License-Identifier: BSD-3-Clause
// The range image as a 16-bit PNG.
#include <png.h>

#include <csetjmp>
#include <cstring>

#include "peers.hpp"

namespace curlidar::bench {
namespace {

using Samples = ImageCoder::Samples;

void append(png_structp png, png_bytep data, std::size_t size) {
  auto& bytes = *static_cast<Bytes*>(png_get_io_ptr(png));
  const auto* first = reinterpret_cast<const std::byte*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

struct Source {
  const Bytes& bytes;
  std::size_t at = 0;
};

void take(png_structp png, png_bytep data, std::size_t size) {
  auto& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (size > source.bytes.size() - source.at) png_error(png, "stream ends early");
  std::memcpy(data, source.bytes.data() + source.at, size);
  source.at += size;
}

/// PNG keeps 16-bit samples with the high byte first.
std::vector<png_byte> big_endian(const Samples& image) {
  std::vector<png_byte> bytes;
  bytes.reserve(2 * image.size());
  for (const std::uint16_t value : image) {
    bytes.push_back(static_cast<png_byte>(value >> 8));
    bytes.push_back(static_cast<png_byte>(value & 0xff));
  }
  return bytes;
}

const Error kFailed{ErrorCode::corrupt, "libpng refused the range image"};

Result<Bytes> pack(const Samples& image, const Mask& mask) {
  Bytes bytes;
  std::vector<png_byte> raw = big_endian(image);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  if (setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return kFailed;
  }
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_compression_level(png, 9);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_ALL_FILTERS);
  png_set_IHDR(png, info, static_cast<png_uint_32>(mask.columns),
               static_cast<png_uint_32>(mask.rows), 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (std::size_t i = 0; i < mask.rows; ++i) png_write_row(png, raw.data() + 2 * mask.columns * i);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

Result<Samples> unpack(const Bytes& bytes, const Mask& mask) {
  Source source{bytes};
  std::vector<png_byte> raw(2 * mask.rows * mask.columns);
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  if (setjmp(png_jmpbuf(png))) {
    png_destroy_read_struct(&png, &info, nullptr);
    return kFailed;
  }
  png_set_read_fn(png, &source, take);
  png_read_info(png, info);
  for (std::size_t i = 0; i < mask.rows; ++i) {
    png_read_row(png, raw.data() + 2 * mask.columns * i, nullptr);
  }
  png_destroy_read_struct(&png, &info, nullptr);
  Samples image(mask.rows * mask.columns);
  for (std::size_t i = 0; i < image.size(); ++i) {
    image[i] = static_cast<std::uint16_t>(raw[2 * i] << 8 | raw[2 * i + 1]);
  }
  return image;
}

}  // namespace

ImageCoder png_coder() {
  return {"png", pack, unpack};
}

}  // namespace curlidar::bench
