// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/result.hpp"

#include "curlidar/version.hpp"

namespace curlidar {

const char* to_string(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_argument: return "invalid argument";
    case ErrorCode::not_found: return "not found";
    case ErrorCode::io: return "io";
    case ErrorCode::corrupt: return "corrupt";
    case ErrorCode::unsupported: return "unsupported";
    case ErrorCode::limit_exceeded: return "limit exceeded";
  }
  return "unknown";
}

const char* version() { return CURLIDAR_VERSION; }

}  // namespace curlidar
