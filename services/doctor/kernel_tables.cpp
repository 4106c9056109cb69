#include "services/doctor/kernel_tables.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>

#include "common/base/read_stream.hpp"

namespace eg::doctor {
namespace {

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(separators), text.size());
    if (end > 0) words.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

template <typename Number>
std::optional<Number> parse(std::string_view word, int base = 10) {
  Number value{};
  const auto parsed = std::from_chars(word.data(), word.data() + word.size(), value, base);
  if (parsed.ec != std::errc{} || parsed.ptr != word.data() + word.size()) return std::nullopt;
  return value;
}

bool has_open(const std::filesystem::path& process, const std::string& link) {
  std::error_code ended;  // what a process that ends meanwhile has left is nothing to throw about
  std::error_code closed;
  for (std::filesystem::directory_iterator it(process / "fd", ended), end; !ended && it != end; it.increment(ended)) {
    if (std::filesystem::read_symlink(it->path(), closed) == link) return true;
  }
  return false;
}

}  // namespace

std::string read_table(const char* path) {
  std::ifstream file(path);
  return base::read_stream(file);
}

std::optional<std::int64_t> snmp_counter(std::string_view snmp, std::string_view protocol, std::string_view counter) {
  std::vector<std::string_view> names;
  for (const std::string_view line : split(snmp, "\n")) {
    const auto words = split(line, " :");
    if (words.empty() || words[0] != protocol) continue;
    if (names.empty()) {
      names = words;
      continue;
    }
    for (std::size_t i = 1; i < names.size() && i < words.size(); ++i) {
      if (names[i] == counter) return parse<std::int64_t>(words[i]);
    }
  }
  return std::nullopt;
}

std::vector<std::uint64_t> sockets_on_port(std::string_view udp, int port) {
  constexpr std::size_t kLocalAddress = 1;
  constexpr std::size_t kInode = 9;
  std::vector<std::uint64_t> inodes;
  for (const std::string_view line : split(udp, "\n")) {
    const auto words = split(line, " ");
    if (words.size() <= kInode) continue;
    const std::string_view address = words[kLocalAddress];
    const std::size_t colon = address.find(':');
    if (colon == std::string_view::npos || parse<int>(address.substr(colon + 1), 16) != port) continue;
    if (const auto inode = parse<std::uint64_t>(words[kInode])) inodes.push_back(*inode);
  }
  return inodes;
}

std::optional<std::string> device_towards(std::string_view route, std::uint32_t address) {
  constexpr std::size_t kDestination = 1;
  constexpr std::size_t kMask = 7;
  std::optional<std::string> device;
  std::uint32_t best_mask = 0;
  for (const std::string_view line : split(route, "\n")) {
    const auto words = split(line, " \t");
    if (words.size() <= kMask) continue;
    const auto destination = parse<std::uint32_t>(words[kDestination], 16);
    const auto mask = parse<std::uint32_t>(words[kMask], 16);
    if (!destination || !mask || (address & *mask) != *destination) continue;
    if (device && ntohl(*mask) < ntohl(best_mask)) continue;  // the most specific route counts
    device = words[0];
    best_mask = *mask;
  }
  return device;
}

std::optional<std::string> default_device(std::string_view route) {
  constexpr std::uint32_t kNowhereSpecial = 0;
  return device_towards(route, kNowhereSpecial);
}

std::optional<std::string> owner_of_socket(std::uint64_t inode) {
  const std::string link = "socket:[" + std::to_string(inode) + "]";
  std::error_code error;
  for (const auto& process : std::filesystem::directory_iterator("/proc", error)) {
    const std::string pid = process.path().filename().string();
    if (!parse<int>(pid) || !has_open(process.path(), link)) continue;
    std::string name;
    std::getline(std::ifstream(process.path() / "comm"), name);
    return name + " (" + pid + ")";
  }
  return std::nullopt;
}

}  // namespace eg::doctor
