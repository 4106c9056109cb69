#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "common/synthetic/scene.hpp"
#include "services/features_eval/sequence_evaluation.hpp"
#include "services/features_eval/synthetic_evaluation.hpp"

namespace {

using eg::features::LineDetectorKind;
using eg::features_eval::SequenceEvaluationOptions;
using eg::features_eval::SyntheticEvaluationOptions;

/// Every scene asked for, exact and with noise.
eg::base::Status evaluate_scenes(const std::vector<std::string>& scenes, SyntheticEvaluationOptions options) {
  for (const std::string& scene : scenes) {
    for (const bool noise : {false, true}) {
      options.scene = scene;
      options.noise = noise;
      if (const auto status = eg::features_eval::evaluate_synthetic(options, std::cout); !status) return status;
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures the accuracy, recall, consistency and time of the feature extraction", "egraph-features-eval");
  app.require_subcommand(1);
  LineDetectorKind detector = eg::features::LineDetectorOptions{}.kind;
  app.add_option("--line-detector", detector, "lsd or edlines")
      ->transform(CLI::CheckedTransformer(std::map<std::string, LineDetectorKind>{
          {"lsd", LineDetectorKind::lsd}, {"edlines", LineDetectorKind::edlines}}));

  std::vector<std::string> scenes = eg::synthetic::scene_names();
  SyntheticEvaluationOptions synthetic;
  const auto* scenes_command = app.add_subcommand("synthetic", "against the exact truth of built-in scenes");
  app.get_subcommand("synthetic")->add_option("SCENE", scenes, "names of scenes")->capture_default_str();
  app.get_subcommand("synthetic")
      ->add_option("--frames", synthetic.frames, "spread over the scene's trajectory")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();

  SequenceEvaluationOptions sequence;
  auto* sequence_command = app.add_subcommand("sequence", "against the true rotations of a recording");
  sequence_command->add_option("DIR", sequence.folder, "TUM or ICL-NUIM folder with ground truth")->required();
  sequence_command->add_option("--camera", sequence.camera, "name of a camera model, or a YAML file")->required();
  sequence_command->add_option("--frames", sequence.max_frames, "only that many; 0: all")
      ->check(CLI::Range(0, 1'000'000));
  sequence_command->add_option("--threads", sequence.threads, "for one frame's features; 0: as many as there are cores")
      ->check(CLI::Range(0, 1024));
  CLI11_PARSE(app, argc, argv);

  synthetic.extractor.lines.detector.kind = detector;
  sequence.extractor.lines.detector.kind = detector;
  try {
    const eg::base::Status status = scenes_command->parsed()
                                        ? evaluate_scenes(scenes, synthetic)
                                        : eg::features_eval::evaluate_sequence(sequence, std::cout);
    if (status) return 0;
    std::cerr << "egraph-features-eval: " << status.error().message << '\n';
  } catch (const std::exception& exception) {
    std::cerr << "egraph-features-eval: " << exception.what() << '\n';
  }
  return 1;
}
