#include "tests/support/recording.hpp"

#include <fstream>
#include <iomanip>
#include <opencv2/imgcodecs.hpp>

#include "common/base/check.hpp"
#include "common/io/camera_file.hpp"
#include "common/io/trajectory_file.hpp"
#include "common/synthetic/sequence.hpp"

namespace eg::test {

void write_recording(const std::filesystem::path& folder, int frames) {
  synthetic::SequenceOptions options;
  options.frame_count = frames;
  const auto sequence = synthetic::SyntheticSequence::make(options);
  EG_CHECK(sequence.has_value(), "the synthetic room exists");
  std::filesystem::create_directories(folder / "rgb");
  std::filesystem::create_directories(folder / "depth");
  std::ofstream colour_list(folder / "rgb.txt");
  std::ofstream depth_list(folder / "depth.txt");
  colour_list << "# colour images\n" << std::fixed << std::setprecision(6);
  depth_list << "# depth images\n" << std::fixed << std::setprecision(6);
  for (int i = 0; i < frames; ++i) {
    const image::RgbdFrame frame = sequence->frame(i);
    const std::string name = std::to_string(i) + ".png";
    cv::imwrite((folder / "rgb" / name).string(), frame.colour, {cv::IMWRITE_PNG_COMPRESSION, 1});
    cv::imwrite((folder / "depth" / name).string(), frame.depth, {cv::IMWRITE_PNG_COMPRESSION, 1});
    const double time_s = 1e-6 * static_cast<double>(sequence->utime(i));
    colour_list << time_s << " rgb/" << name << '\n';
    depth_list << time_s << " depth/" << name << '\n';
  }
  const bool written = io::write_trajectory(folder / "groundtruth.txt", sequence->ground_truth()).has_value() &&
                       io::write_camera(folder / "camera.yaml", options.camera).has_value();
  EG_CHECK(written, "the folder can be written to");
}

}  // namespace eg::test
