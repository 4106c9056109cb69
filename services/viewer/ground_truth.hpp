#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/geometry/pose.hpp"
#include "services/viewer/board.hpp"

namespace eg::services {

/// The true trajectory from a file in TUM format, moved rigidly to where the estimate is. The file may come into being
/// later; one that cannot be read is left alone.
class GroundTruth {
 public:
  /// @param file empty: there is none
  explicit GroundTruth(std::filesystem::path file) : file_(std::move(file)) {}

  [[nodiscard]] bool is_given() const { return !file_.empty(); }

  /// Puts the packet "truth": the part of the true trajectory in the estimate's time.
  bool put(Board& board, const std::vector<geometry::StampedPose>& estimate);

 private:
  void read_if_new();

  std::filesystem::path file_;
  std::filesystem::file_time_type written_{};
  std::vector<geometry::StampedPose> poses_;
};

}  // namespace eg::services
