#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/eval/result_table.hpp"

namespace eg::eval {

/// Figures of other systems on known sequences, as their papers print them.
struct PublishedTable {
  enum class Measure { ate_rmse_m, are_mean_deg };

  Measure measure = Measure::ate_rmse_m;
  std::string title;
  std::vector<std::string> systems;
  std::map<std::string, std::vector<Cell>> rows;  ///< by KnownSequence::name, one value per system
};

/// The paper's tables (Li, Tombari, ECCV 2022: absolute rotation error; translation RMSE; translation against systems
/// that use a graphics card), and for the recordings of features what Open-Structure's own baseline reaches on them.
const std::vector<PublishedTable>& published_tables();

/// What was measured here on one sequence.
struct SequenceResult {
  std::string sequence;             ///< KnownSequence::name
  double ate_rmse_m = 0.0;          ///< NaN: failed, like the others
  double are_mean_deg = 0.0;        ///< after rotation alignment
  double are_first_pose_deg = 0.0;  ///< mean after aligning the first pose
};

/// Every published table that has something to say about the results, ours in the first column (rotation: in the first
/// two, by either alignment).
std::vector<ResultTable> compare_with_published(const std::vector<SequenceResult>& results);

}  // namespace eg::eval
