#include "services/viewer/ground_truth.hpp"

#include <spdlog/spdlog.h>

#include <system_error>

#include "common/eval/alignment.hpp"
#include "common/io/trajectory_file.hpp"
#include "services/viewer/arrays.hpp"
#include "services/viewer/packet.hpp"

namespace eg::services {
namespace {

constexpr std::size_t kFewestPairs = 10;          ///< a shorter piece of a trajectory aligns in many ways
constexpr double kMaxTimeDifference = 0.02;       // seconds
constexpr double kBeforeAndAfterEstimate = 0.05;  // seconds

}  // namespace

bool GroundTruth::put(Board& board, const std::vector<geometry::StampedPose>& estimate) {
  if (!is_given() || estimate.size() < kFewestPairs) return true;
  read_if_new();
  const auto pairs = eval::match_by_time(estimate, poses_, kMaxTimeDifference);
  if (pairs.size() < kFewestPairs) return true;
  const geometry::Pose estimate_from_truth = eval::align_positions(pairs).inverse();
  const double begin = estimate.front().time_s - kBeforeAndAfterEstimate;
  const double end = estimate.back().time_s + kBeforeAndAfterEstimate;
  std::vector<float> positions;
  for (const geometry::StampedPose& pose : poses_) {
    if (pose.time_s < begin || pose.time_s > end) continue;
    append(positions, estimate_from_truth * pose.world_from_camera.translation);
  }
  return board.put("truth", Packet("truth").array("positions", positions).bytes());
}

void GroundTruth::read_if_new() {
  std::error_code missing;
  const auto written = std::filesystem::last_write_time(file_, missing);
  if (missing || written == written_) return;
  written_ = written;
  auto poses = io::read_trajectory(file_);
  if (!poses) return spdlog::warn("no ground truth: {}", poses.error().message);
  poses_ = std::move(*poses);
}

}  // namespace eg::services
