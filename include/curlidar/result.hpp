// SPDX-License-Identifier: BSD-3-Clause
// Errors are values: every fallible public function returns a Result<T>.
#pragma once

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace curlidar {

enum class ErrorCode {
  invalid_argument,  ///< a setting or option makes no sense
  not_found,         ///< a file, a sensor name, a chunk is missing
  io,                ///< the operating system refused a read or a write
  corrupt,           ///< the bytes are damaged or are not what they claim to be
  unsupported,       ///< well formed, but not something this version handles
  limit_exceeded,    ///< larger than the caller's limits allow
};

/// Short lower-case name of a code ("corrupt", "io", ...).
const char* to_string(ErrorCode code);

/// What went wrong, where and what to do about it, in one sentence a user can act on.
struct Error {
  ErrorCode code = ErrorCode::invalid_argument;
  std::string message;
};

/// Either a value or an Error. Test with `if (!result)` before touching the value.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  T& value() & { return assert(has_value()), *std::get_if<0>(&state_); }
  const T& value() const& { return assert(has_value()), *std::get_if<0>(&state_); }
  T&& value() && { return assert(has_value()), std::move(*std::get_if<0>(&state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const Error& error() const { return assert(!has_value()), *std::get_if<1>(&state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)), ok_(false) {}  // NOLINT: implicit

  bool has_value() const { return ok_; }
  explicit operator bool() const { return ok_; }
  const Error& error() const { return assert(!ok_), error_; }

 private:
  Error error_;
  bool ok_ = true;
};

using Status = Result<void>;

}  // namespace curlidar
