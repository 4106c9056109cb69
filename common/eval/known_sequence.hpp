#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

/// The sequences of the paper's tables and of Open-Structure, and how their folders are called.
namespace eg::eval {

struct KnownSequence {
  const char* name;           ///< as in the paper's tables
  const char* camera;         ///< for --camera
  const char* pattern;        ///< of the last two parts of a folder's path, joined by '/', in lower case (ECMAScript)
  bool observations = false;  ///< a recording of features
};

std::span<const KnownSequence> known_sequences();

/// The sequence in a folder with this path, by its last two parts: `living_room_traj0_frei_png`, `of_kt2`,
/// `rgbd_dataset_freiburg3_cabinet`, `tum_fr1_room`, `open_structure/office0`, ... Null: another one.
const KnownSequence* find_sequence(std::string_view path, bool observations);

}  // namespace eg::eval
