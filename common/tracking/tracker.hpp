#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/egraph/graph.hpp"
#include "common/tracking/bundle_adjustment.hpp"
#include "common/tracking/direction_tracks.hpp"
#include "common/tracking/graph_rotation.hpp"
#include "common/tracking/keyframe_policy.hpp"
#include "common/tracking/map.hpp"
#include "common/tracking/map_correction.hpp"
#include "common/tracking/matcher.hpp"
#include "common/tracking/motion_model.hpp"
#include "common/tracking/observability.hpp"
#include "common/tracking/pose_estimate.hpp"
#include "common/tracking/pose_optimizer.hpp"
#include "common/tracking/relocaliser.hpp"
#include "common/tracking/tracker_parts.hpp"
#include "common/tracking/translation_solver.hpp"

namespace eg::tracking {

struct TrackerOptions {
  GraphRotationOptions rotation;
  TranslationOptions translation;
  MatchOptions search;                 ///< around the predicted pose
  double refined_search_radius = 7.0;  ///< pixels, around the pose found in the first step
  PoseOptimizerOptions optimizer;
  MotionOptions motion;
  KeyframeOptions keyframes;
  RelocaliserOptions relocaliser;
  BundleOptions bundle;
  TrackerParts parts;
  int relocalisation_candidates = 4;         ///< keyframes tried per lost frame
  double max_translation_sigma = 0.05;       ///< metres: worse is `rotation_only`
  double max_rotation_sigma = 0.0175;        ///< radians (1°): worse is `lost`
  double max_turn_of_directions = 0.785;     ///< radians (45°): beyond it the walls of a box are each other's
  double max_unseen_turn = 0.14;             ///< radians (8°): beyond it the next wall is not told from its neighbours
  std::int64_t max_leap_utime = 60'000'000;  ///< microseconds; a longer leap ahead takes two frames to be believed
  std::int64_t max_past_utime = 1'000'000;   ///< microseconds of frames in order before the last: a clock set back
  std::int64_t max_blind_utime = 2'000'000;  ///< microseconds for which the last pose still says where to look
  int min_points_without_planes = 7;         ///< fewer agreeing points are no proof of a pose
  int min_lines_without_planes = 4;          ///< the same of lines
  int min_named_points = 4;                  ///< of known identity: three determine a pose and one confirms it
  int min_expected_points = 20;  ///< so many, and hardly one found: planes that fit are another room corner's
};

/// What became of a frame.
struct TrackResult {
  PoseEstimate estimate;
  std::optional<egraph::Keyframe> keyframe;        ///< to announce, if the frame became one
  std::vector<PoseCorrection::Entry> corrections;  ///< of older keyframes, to announce
};

/// The tracker: rotation from the E-Graph, translation, frame-to-map refinement, keyframes and local map (paper,
/// section 5). Owns its map and a replica of the graph; knows no clock, no messages and no threads.
class Tracker {
 public:
  explicit Tracker(TrackerOptions options = {});

  TrackResult track(const features::FrameFeatures& frame);

  /// The answer to a frame of which nothing but the header can be used: no pose, the state is as before. `reason`: why.
  [[nodiscard]] TrackResult refuse(const image::FrameHeader& header, std::string reason) const;

  /// Goes on in a map of an earlier session, together with its graph: lost until a frame shows a known place. To be
  /// called before the first frame.
  void continue_in(Map map, egraph::Graph graph);

  /// Brings the replica of the E-Graph up to date. If the server has refined the graph, the map follows; returns the
  /// keyframes that moved. Refuses what does not lead on from the replica (a gap: ask for a snapshot).
  base::Result<std::vector<egraph::CorrectedPose>> follow(const egraph::GraphUpdate& update);
  base::Result<std::vector<egraph::CorrectedPose>> follow(const egraph::GraphSnapshot& snapshot);

  [[nodiscard]] const egraph::Graph& graph() const { return graph_; }
  [[nodiscard]] const Map& map() const { return map_; }

 private:
  struct Frame;

  TrackResult track_parts(const features::FrameFeatures& features);
  TrackResult initialise(const features::FrameFeatures& features);
  TrackResult recover(const features::FrameFeatures& features, const std::string& why);
  /// A keyframe at the predicted pose, where nothing but a wall was seen before: nothing known could ever correct it.
  TrackResult begin_anew(Frame& frame);
  /// The same when the prediction is worth nothing.
  TrackResult begin_anew(const features::FrameFeatures& features);
  /// Where the descriptors of a keyframe's points put the camera. Tries a few keyframes, other ones each time.
  std::optional<Frame> find_known_place(const features::FrameFeatures& features);
  TrackResult go_on_at_known_place(Frame& frame);
  TrackResult finish(Frame& frame, TrackingState state, std::string reason);
  /// Why a frame of this time cannot be the next one; empty if it can.
  std::string time_objection(std::int64_t utime);
  /// Whether a frame from before the last one shows that the clock was set back.
  bool clock_was_set_back(std::int64_t utime);

  /// Rotation from the graph, translation, refinement; without the graph where it leads away from the map's points.
  [[nodiscard]] Frame estimate(const features::FrameFeatures& features) const;
  [[nodiscard]] Frame estimate(const features::FrameFeatures& features, bool with_graph) const;
  void follow_graph_rotation(Frame& frame) const;
  void estimate_translation_with_rotation_fixed(Frame& frame) const;
  void refine_against_map(Frame& frame) const;
  void match_and_build_problem(Frame& frame, double radius) const;
  void keep_inliers(Frame& frame) const;
  void count_visibility(const Frame& frame);
  /// Whether so much agrees with the map that it is no chance.
  [[nodiscard]] bool is_proven(const Frame& frame) const;
  /// Whether the prediction, with the little that was measured, still knows the rotation.
  [[nodiscard]] bool goes_on_as_before(const Frame& frame) const;
  /// Whether one wall holds two turns and a distance while the third turn has been predicted for a short time only.
  [[nodiscard]] bool follows_one_wall(const Frame& frame, const Observability& observed) const;
  /// Whether the prediction is sharper than the gates within which planes are matched: no other plane can stand in.
  [[nodiscard]] bool planes_are_unmistakable(const Frame& frame) const;
  /// Whether a map of these features could tell a rotation: enough points or lines, or walls that are not parallel.
  [[nodiscard]] bool tells_pose(const features::FrameFeatures& features) const;
  /// Whether all that the map holds is a few points and lines, and planes that are parallel.
  [[nodiscard]] bool map_tells_no_pose() const;
  /// Whether directions alone tell the rotation: a prediction less sharp does not tell those of a room apart.
  [[nodiscard]] bool directions_are_unmistakable(const Frame& frame) const;
  /// Many points are expected and many are seen, but they are not the same.
  [[nodiscard]] bool misses_expected_points(const Frame& frame) const;
  /// That, or most planes in view are not those of the map.
  [[nodiscard]] bool leads_away(const Frame& frame) const;
  /// Points and lines of the map that the pose puts where they are seen.
  [[nodiscard]] int found(const Frame& frame) const;
  /// Less than half of what the frame before found: hardly any movement between two frames explains that.
  [[nodiscard]] bool finds_much_less(const Frame& frame) const;
  /// That, or leads away though the prediction is sharp.
  [[nodiscard]] bool is_doubtful(const Frame& frame) const;
  /// Missing points after a loss or a long step.
  [[nodiscard]] bool points_contradict(const Frame& frame) const;
  [[nodiscard]] bool sees_new_structure(const Frame& frame) const;
  [[nodiscard]] int features_of_last_keyframe(const Frame& frame) const;
  /// The frame's directions seen from where the map alone puts the camera; empty where the map does not know that.
  [[nodiscard]] std::optional<DirectionViews> direction_views(const Frame& frame) const;
  /// Of the frame's pose as the map alone measured it, without the directions, which the graph counts by themselves.
  [[nodiscard]] Matrix6d covariance_by_map(const Frame& frame) const;
  void add_keyframe(Frame& frame, TrackResult& result);
  /// Local bundle adjustment around the newest keyframe. Returns the other keyframes that moved.
  std::vector<PoseCorrection::Entry> adjust_local_map();
  /// What the server has to know of older keyframes: where local bundle adjustment has put them.
  void report_moved_keyframes(egraph::Keyframe& keyframe) const;
  std::vector<egraph::CorrectedPose> correct_map(std::span<const KeyframeCorrection> corrections, KeyframeId newest);

  TrackerOptions options_;
  egraph::Graph graph_;
  Map map_;
  MotionModel motion_;
  KeyframePolicy policy_;
  DirectionTracks direction_tracks_;                   ///< since the last keyframe
  TrackingState state_ = TrackingState::initialising;  ///< after the last frame that was not refused
  std::int64_t last_utime_ = -1;
  std::int64_t leap_utime_ = -1;           ///< of a refused frame that came from far ahead
  std::int64_t past_begin_utime_ = -1;     ///< of the first of the frames refused in a row as earlier than the last one
  std::int64_t past_utime_ = -1;           ///< of the newest of them
  std::int64_t last_measured_utime_ = -1;  ///< when the rotation was last determined
  int last_found_ = 0;                     ///< points and lines, by the last frame that measured its rotation
  bool lost_ = false;
  std::size_t next_candidate_ = 0;  ///< round robin over keyframes while lost
};

}  // namespace eg::tracking
