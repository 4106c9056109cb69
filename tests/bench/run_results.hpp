#pragma once

#include <spdlog/spdlog.h>

#include <array>
#include <filesystem>

#include "tests/support/program.hpp"

namespace eg::bench {

/// What a lockstep run computes, in files.
inline constexpr std::array kResults = {"trajectory.txt", "states.csv", "keyframes.txt",
                                        "egraph.json",    "map.ply",    "mesh.ply"};

/// Whether a disturbed run has found what the undisturbed one has, to the last byte; says what differs.
inline bool same_results(const std::filesystem::path& undisturbed, const std::filesystem::path& disturbed) {
  bool same = true;
  for (const char* name : kResults) {
    const std::string expected = test::file_bytes(undisturbed / name);
    if (!expected.empty() && expected == test::file_bytes(disturbed / name)) continue;
    spdlog::error("{} is not that of the undisturbed run", name);
    same = false;
  }
  return same;
}

}  // namespace eg::bench
