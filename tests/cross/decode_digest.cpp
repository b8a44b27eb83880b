// SPDX-License-Identifier: BSD-3-Clause
// decode_digest [FILE...]: prints digests of what decoding computes, for comparison between
// machines; of each .curl file too. Exit code 1 if a file cannot be read.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "cross/decode_sections.hpp"

namespace {

bool digest_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    std::fprintf(stderr, "decode_digest: cannot read %s\n", path.c_str());
    return false;
  }
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  curlidar::test::Digest digest;
  curlidar::test::digest_container(digest, std::as_bytes(std::span(text)));
  curlidar::test::digest_scan_file(digest, std::as_bytes(std::span(text)));
  digest.print(path.substr(path.find_last_of('/') + 1).c_str());
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  curlidar::test::digest_decoding();
  for (int i = 1; i < argc; ++i) {
    if (!digest_file(argv[i])) return 1;
  }
  return 0;
}
