#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/eval/known_sequence.hpp"
#include "common/eval/trajectory_errors.hpp"

/// Runs of the whole system on benchmark sequences.
namespace eg::service {

struct FoundSequence {
  const eval::KnownSequence* sequence = nullptr;
  std::filesystem::path folder;
};

/// The known sequences under `root` (itself included), in the order of the published tables.
base::Result<std::vector<FoundSequence>> find_sequences(const std::filesystem::path& root);

struct RunPlan {
  std::filesystem::path out;     ///< every sequence gets a folder of its own in it
  std::filesystem::path config;  ///< for egraph-run; empty: none
  std::int64_t frames = 0;       ///< at most; 0: all
  bool keep = false;             ///< results of earlier runs are used where they are there
};

/// Runs egraph-run (the program beside this one) on a sequence, without the mapper and in lockstep, and measures its
/// trajectory. The error says what failed.
base::Result<eval::TrajectoryErrors> run_sequence(const FoundSequence& found, const RunPlan& plan);

}  // namespace eg::service
