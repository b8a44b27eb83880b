// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace curlidar {

/// Version of the library, "major.minor.patch".
const char* version();

}  // namespace curlidar
