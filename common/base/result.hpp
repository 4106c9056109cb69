#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace eg::base {

/// What went wrong with untrusted input or the environment: one sentence for a person, naming the file, line, key,
/// channel or field.
struct Error {
  std::string message;
};

/// A value, or the reason why there is none. Used wherever input is not trusted (files, messages, configuration).
template <typename T>
using Result = tl::expected<T, Error>;

/// Success, or the reason for the failure.
using Status = Result<void>;

inline tl::unexpected<Error> fail(std::string message) { return tl::make_unexpected(Error{std::move(message)}); }

}  // namespace eg::base
