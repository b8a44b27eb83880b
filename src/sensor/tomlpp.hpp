// SPDX-License-Identifier: BSD-3-Clause
// toml++ without exceptions and without its assertions. Version 3.3 asserts some things that files
// may break ("[=]"), and in release builds tells the compiler to rely on them; each has an ordinary
// error behind it, which this leaves in force. Everybody who reads TOML includes this.
#pragma once

#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(condition) static_cast<void>(0)
#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")
