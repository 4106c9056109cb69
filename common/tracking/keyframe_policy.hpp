#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace eg::tracking {

struct KeyframeOptions {
  int max_frames = 20;              ///< frames since the last keyframe (paper, section 4.2)
  double min_tracked_ratio = 0.85;  ///< of the last keyframe's features that the best frame since found (paper, 4.2)
  double min_tracked_ratio_of_many = 0.70;  ///< the same where that frame found `many_features`
  int many_features = 200;  ///< so many fix a pose to a fourteenth of a feature's noise: more keyframes cost time only
  int min_frames = 5;       ///< a shorter distance tells nothing new: a sixth of a second
  int new_structure_frames = 2;  ///< frames in a row that must see a new plane or vanishing direction
};

/// When a frame becomes a keyframe: the rules of the paper's section 4.2.
class KeyframePolicy {
 public:
  explicit KeyframePolicy(KeyframeOptions options = {}) : options_(options) {}

  /// `tracked`: features of the last keyframe found in this frame. `sees_new_structure`: a plane or vanishing direction
  /// that neither map nor graph knows. Returns whether this frame should be a keyframe.
  bool wants_keyframe(int tracked, bool sees_new_structure);

  void keyframe_added();

 private:
  KeyframeOptions options_;
  int frames_since_ = 0;
  int best_tracked_ = 0;  ///< what the frames after the keyframe could find of it at most
  int new_structure_run_ = 0;
};

}  // namespace eg::tracking
