#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace eg::test {

/// A packet as the page reads it.
struct ReadPacket {
  explicit ReadPacket(const std::string& bytes) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data(), sizeof size);
    EXPECT_EQ(size % 4, 0u);
    head = nlohmann::json::parse(bytes.begin() + 4, bytes.begin() + 4 + size);
    std::size_t offset = 4 + size;
    for (const auto& array : head["arrays"]) {
      const std::string element = array[1];
      const std::size_t width = element.ends_with("32") ? 4 : element.ends_with("16") ? 2 : 1;
      const std::size_t count = array[2];
      arrays[array[0]] = bytes.substr(offset, width * count);
      offset += (width * count + 3) / 4 * 4;
    }
    EXPECT_EQ(offset, bytes.size());
  }

  template <typename T>
  std::vector<T> array(const std::string& name) const {
    const std::string& bytes = arrays.at(name);
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }

  nlohmann::json head;
  std::map<std::string, std::string> arrays;
};

}  // namespace eg::test
