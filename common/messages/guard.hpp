#pragma once

#include <exception>
#include <string>

#include "common/base/result.hpp"
#include "common/messages/checker.hpp"

namespace eg::messages {

/// Runs `decode`, which fills a value and tells a Checker what is wrong; gives the value, or the first complaint.
/// Whatever the libraries underneath throw at a hostile message (no memory, OpenCV) becomes an error too.
template <typename T, typename Decode>
base::Result<T> guarded(const Decode& decode) {
  try {
    return decode();
  } catch (const std::exception& exception) {
    return base::fail(std::string("the message cannot be decoded: ") + exception.what());
  }
}

/// The value, unless `check` has complained.
template <typename T>
base::Result<T> checked(T value, const Checker& check) {
  if (const auto status = check.status(); !status) return tl::make_unexpected(status.error());
  return value;
}

}  // namespace eg::messages
