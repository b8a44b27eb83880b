// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <png.h>

#include <cstring>

#include "curlidar/io.hpp"
#include "curlidar/render.hpp"

namespace curlidar {

Status write_png(const std::string& path, const Image& image) {
  if (image.width == 0 || image.height == 0 ||
      image.rgb.size() != static_cast<std::size_t>(image.width) * image.height * 3) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{}: a picture of {} x {} pixels with {} bytes cannot be written",
                             path, image.width, image.height, image.rgb.size())};
  }
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  header.width = image.width;
  header.height = image.height;
  header.format = PNG_FORMAT_RGB;
  // An upper bound of the compressed size, so that one pass is enough. No time is stored: the
  // same picture gives the same bytes.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<std::byte> bytes(size);
  const bool written =
      png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) != 0;
  if (!written) {
    return Error{ErrorCode::invalid_argument, fmt::format("{}: libpng: {}", path, header.message)};
  }
  bytes.resize(size);
  return write_file(path, bytes);
}

}  // namespace curlidar
