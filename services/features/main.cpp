#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>

#include "common/features/feature_extractor.hpp"
#include "common/image/rectifier.hpp"
#include "common/io/camera_file.hpp"
#include "common/io/image_file.hpp"
#include "services/features/feature_drawing.hpp"
#include "services/features/feature_report.hpp"

namespace {

using eg::features::LineDetectorKind;

struct Arguments {
  std::filesystem::path colour, depth, out;
  std::string camera;
  int repeats = 10;
  LineDetectorKind line_detector = eg::features::LineDetectorOptions{}.kind;
};

eg::base::Result<eg::image::RgbdFrame> read_frame(const Arguments& arguments) {
  const auto camera = eg::io::read_camera(arguments.camera);
  if (!camera) return eg::base::fail(camera.error().message);
  const auto colour = eg::io::read_image(arguments.colour);
  if (!colour) return eg::base::fail(colour.error().message);
  const auto depth = eg::io::read_image(arguments.depth);
  if (!depth) return eg::base::fail(depth.error().message);

  const cv::Size size(camera->width, camera->height);
  if (colour->type() != CV_8UC3 || colour->size() != size) {
    return eg::base::fail(arguments.colour.string() + ": not an 8 bit colour image of the camera's size");
  }
  if (depth->type() != CV_16UC1 || depth->size() != size) {
    return eg::base::fail(arguments.depth.string() + ": not a 16 bit depth image of the camera's size");
  }
  return eg::image::RgbdFrame{{}, *camera, *colour, *depth};
}

eg::base::Status run(const Arguments& arguments) {
  const auto frame = read_frame(arguments);
  if (!frame) return eg::base::fail(frame.error().message);
  const eg::image::RectifiedFrame rectified = eg::image::Rectifier().rectify(*frame);

  eg::features::FeatureExtractorOptions options;
  options.lines.detector.kind = arguments.line_detector;
  eg::features::FeatureExtractor extractor(options);
  const eg::features::FrameFeatures features = extractor.extract(rectified);
  eg::features_tool::print_features(std::cout, features);
  if (arguments.repeats > 0) eg::features_tool::print_timings(std::cout, rectified, options, arguments.repeats);

  const cv::Mat drawing = eg::features_tool::draw_features(rectified.colour, extractor.plane_labels(), features);
  return eg::io::write_png(arguments.out, drawing);
}

}  // namespace

int main(int argc, char** argv) {
  const std::map<std::string, LineDetectorKind> detectors{{"lsd", LineDetectorKind::lsd},
                                                          {"edlines", LineDetectorKind::edlines}};
  Arguments arguments;
  CLI::App app("Draws the features of one frame into a picture and prints what was found and how long it took",
               "egraph-features");
  app.add_option("IMAGE", arguments.colour, "Colour image")->required();
  app.add_option("DEPTH", arguments.depth, "Depth image, registered to it")->required();
  app.add_option("--camera", arguments.camera, "Name of a camera model, or a YAML file")->required();
  app.add_option("--out", arguments.out, "Picture to write (.png)")->required();
  app.add_option("--repeat", arguments.repeats, "Runs to take the mean time of; 0: no timing")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--line-detector", arguments.line_detector, "lsd or edlines")
      ->transform(CLI::CheckedTransformer(detectors));
  CLI11_PARSE(app, argc, argv);

  try {
    const eg::base::Status status = run(arguments);
    if (status) return 0;
    std::cerr << "egraph-features: " << status.error().message << '\n';
  } catch (const std::exception& exception) {
    std::cerr << "egraph-features: " << exception.what() << '\n';
  }
  return 1;
}
