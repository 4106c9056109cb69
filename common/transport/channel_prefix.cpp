#include "common/transport/channel_prefix.hpp"

#include <algorithm>

namespace eg::transport {
namespace {

bool allowed(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.' ||
         c == '/' || c == '-';
}

}  // namespace

base::Result<std::string> ChannelPrefix::add(std::string_view channel) const {
  std::string name = prefix_ + std::string(channel);
  if (channel.empty()) return base::fail("a channel needs a name");
  if (name.size() > kMaxChannelLength) {
    return base::fail("channel name '" + name + "' is longer than " + std::to_string(kMaxChannelLength) +
                      " characters");
  }
  if (!std::all_of(name.begin(), name.end(), allowed)) {
    return base::fail("channel name '" + name + "' has other characters than letters, digits and _ . / -");
  }
  return name;
}

}  // namespace eg::transport
