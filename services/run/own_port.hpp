#pragma once

#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "common/procman/file_descriptor.hpp"

namespace eg::run {

/// An LCM URL that no other egraph-run of this machine (more exactly, of its network namespace) uses while this object
/// lives. Held as an abstract Unix socket named after the port, so that nothing is left behind in any case.
class OwnPort {
 public:
  /// Takes a free port, clear of everything that is bound to UDP.
  static base::Result<OwnPort> find();

  /// Takes the port of `url`; an error if another run has it. A URL without a UDP port needs none.
  static base::Result<OwnPort> take(const std::string& url);

  [[nodiscard]] const std::string& url() const { return url_; }

 private:
  OwnPort(std::string url, procman::FileDescriptor lock) : url_(std::move(url)), lock_(std::move(lock)) {}

  std::string url_;
  procman::FileDescriptor lock_;
};

}  // namespace eg::run
