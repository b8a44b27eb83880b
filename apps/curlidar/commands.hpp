// SPDX-License-Identifier: BSD-3-Clause
// Every command of the program, each in the file of its name.
#pragma once

#include "common_options.hpp"

namespace curlidar::app {

Command add_encode(CLI::App& root);
Command add_decode(CLI::App& root);
Command add_mesh(CLI::App& root);
Command add_upsample(CLI::App& root);
Command add_convert(CLI::App& root);
Command add_info(CLI::App& root);
Command add_project(CLI::App& root);
Command add_compare(CLI::App& root);
Command add_simulate(CLI::App& root);
Command add_verify(CLI::App& root);
Command add_render(CLI::App& root);
Command add_sensors(CLI::App& root);
Command add_calibrate(CLI::App& root);
Command add_demo(CLI::App& root);
Command add_register(CLI::App& root);
Command add_map(CLI::App& root);
Command add_report(CLI::App& root);

}  // namespace curlidar::app
