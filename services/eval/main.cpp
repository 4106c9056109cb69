#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "services/eval/commands.hpp"
#include "services/eval/report_command.hpp"
#include "services/eval/table_command.hpp"

namespace {

using eg::service::Report;

/// Prints a result or the reason why there is none; returns the exit code.
int finish(const eg::base::Result<Report>& report, bool as_json) {
  if (!report) {
    std::fprintf(stderr, "egraph-eval: %s\n", report.error().message.c_str());
    return 1;
  }
  using Json = nlohmann::ordered_json;  // in which names of files that are no UTF-8 are replaced
  const std::string text = report->json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  std::fputs(as_json ? text.c_str() : report->table.c_str(), stdout);
  return 0;
}

int finish(const eg::base::Status& status) {
  if (status) return 0;
  std::fprintf(stderr, "egraph-eval: %s\n", status.error().message.c_str());
  return 1;
}

struct Arguments {
  std::string estimate;
  std::string reference;
  std::string camera = "synthetic";
  std::string trajectory;
  std::string groundtruth;
  bool json = false;
  eg::service::PictureFiles picture;
  eg::service::ReportFiles report;
  std::string out;
  std::vector<std::string> parts;
  bool y_up = false;
  std::string root;
  std::string configs;
  eg::service::RunPlan plan;
  eg::service::CloudSource cloud;
  eg::eval::DepthCloudOptions cloud_options;
};

CLI::App* add_command(CLI::App& app, Arguments& arguments, const char* name, const char* what, const char* estimate,
                      const char* reference) {
  CLI::App* command = app.add_subcommand(name, what);
  command->add_option(estimate, arguments.estimate, "what was computed")->required();
  command->add_option(reference, arguments.reference, "what is true")->required();
  command->add_flag("--json", arguments.json, "print JSON");
  return command;
}

CLI::App* add_render_command(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand("render", "draw mesh, trajectories and keyframes into a PNG file");
  command->add_option("--mesh", arguments.picture.mesh, "mesh.ply");
  command->add_option("--trajectory", arguments.picture.trajectory, "estimated trajectory (TUM format)");
  command->add_option("--groundtruth", arguments.picture.groundtruth, "true trajectory, aligned to the estimate");
  command->add_option("--graph", arguments.picture.graph, "egraph.json, for the keyframes");
  command->add_option("--out", arguments.out, "PNG file to write")->required();
  command->add_flag("--y-up", arguments.y_up, "the camera has a negative fy (ICL-NUIM): its y axis points up");
  command->add_flag("--json", arguments.json, "print JSON");
  return command;
}

CLI::App* add_report_command(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand("report", "describe a run in one report.html in its folder");
  command->add_option("FOLDER", arguments.report.folder, "what egraph-run --out has written")
      ->required()
      ->check(CLI::ExistingDirectory);
  command->add_option("--groundtruth", arguments.report.groundtruth, "true trajectory (TUM format)");
  command->add_option("--config", arguments.report.config, "YAML configuration that the run had");
  command->add_flag("--y-up", arguments.y_up, "the camera has a negative fy (ICL-NUIM): its y axis points up");
  return command;
}

CLI::App* add_join_command(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand("join", "join the meshes of mappers that share the space (--tiles) into one");
  command->add_option("OUT", arguments.out, "PLY file to write")->required();
  command->add_option("PARTS", arguments.parts, "mesh.0.ply mesh.1.ply ...")->required();
  command->add_flag("--json", arguments.json, "print JSON");
  return command;
}

CLI::App* add_cloud_command(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "cloud", "write what all depth images of a recording show at their true poses, as a reference for mesh");
  command->add_option("DATASET", arguments.cloud.dataset, "folder of the recording")
      ->required()
      ->check(CLI::ExistingDirectory);
  command->add_option("--camera", arguments.cloud.camera, "NAME or FILE.yaml; else by the folder");
  command->add_option("--groundtruth", arguments.cloud.groundtruth, "true trajectory; else the recording's own");
  command->add_option("--out", arguments.out, "PLY file to write")->required();
  command->add_option("--spacing", arguments.cloud_options.spacing, "one point per cube of this side, metres")
      ->check(CLI::Range(0.001, 1.0))
      ->capture_default_str();
  command->add_option("--max-depth", arguments.cloud_options.max_depth, "leave out farther readings, metres; 0: none")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command->add_flag("--json", arguments.json, "print JSON");
  return command;
}

CLI::App* add_runs_command(CLI::App& app, Arguments& arguments, const char* name, const char* what) {
  CLI::App* command = app.add_subcommand(name, what);
  command->add_option("ROOT", arguments.root, "folder with recordings, at any depth")->required();
  command->add_option("--out", arguments.plan.out, "folder for the runs and the tables")->required();
  command->add_option("--frames", arguments.plan.frames, "at most this many frames of each; 0: all")
      ->check(CLI::Range(std::int64_t{0}, INT64_MAX));
  command->add_option("--config", arguments.plan.config, "YAML configuration for egraph-run")->check(CLI::ExistingFile);
  command->add_flag("--keep", arguments.plan.keep, "use the results of earlier runs that are in --out");
  return command;
}

int run(int argc, char** argv) {
  CLI::App app("Measures results of E-Graph SLAM against ground truth and draws them.", "egraph-eval");
  app.require_subcommand(1);
  Arguments arguments;
  const auto* trajectory =
      add_command(app, arguments, "trajectory", "errors of a camera trajectory (TUM format)", "EST", "GT");
  const auto* drift =
      add_command(app, arguments, "drift", "how errors grow with time and with the way gone", "EST", "GT");
  auto* graph = add_command(app, arguments, "graph", "rotation error of every edge of the E-Graph", "GRAPH", "GT");
  graph->add_option("--camera", arguments.camera, "NAME or FILE.yaml: its field of view tells which views overlap")
      ->capture_default_str();
  auto* mesh = add_command(app, arguments, "mesh", "accuracy and completeness of a mesh (PLY)", "MESH", "REF");
  auto* estimate = mesh->add_option("--trajectory", arguments.trajectory, "estimated trajectory, to align the mesh by");
  auto* truth = mesh->add_option("--groundtruth", arguments.groundtruth, "true trajectory, to align the mesh to");
  estimate->needs(truth);
  truth->needs(estimate);
  const auto* render = add_render_command(app, arguments);
  const auto* report = add_report_command(app, arguments);
  const auto* join = add_join_command(app, arguments);
  const auto* cloud = add_cloud_command(app, arguments);
  const auto* table = add_runs_command(
      app, arguments, "table", "run egraph-run on every known sequence, print the paper's tables with our column");
  auto* ablation = add_runs_command(app, arguments, "ablation", "the same with parts switched off by configurations");
  ablation->add_option("--configs", arguments.configs, "folder of YAML configurations, one per column")->required();
  auto* edges = app.add_subcommand("edges", "draw the edges of the E-Graph beside those of covisibility");
  edges->add_option("GRAPH", arguments.estimate, "egraph.json")->required();
  edges->add_option("--out", arguments.out, "PNG file to write")->required();
  edges->add_flag("--y-up", arguments.y_up, "the camera has a negative fy (ICL-NUIM): its y axis points up");
  edges->add_flag("--json", arguments.json, "print JSON");
  CLI11_PARSE(app, argc, argv);

  using namespace eg::service;
  if (trajectory->parsed()) return finish(report_trajectory(arguments.estimate, arguments.reference), arguments.json);
  if (drift->parsed()) return finish(report_drift(arguments.estimate, arguments.reference), arguments.json);
  if (graph->parsed()) {
    return finish(report_graph(arguments.estimate, arguments.reference, arguments.camera), arguments.json);
  }
  if (render->parsed()) {
    return finish(render_picture(arguments.picture, arguments.y_up, arguments.out), arguments.json);
  }
  if (edges->parsed()) {
    return finish(render_edges(arguments.estimate, arguments.y_up, arguments.out), arguments.json);
  }
  if (report->parsed()) return finish(report_run(arguments.report, arguments.y_up), false);
  if (join->parsed()) return finish(join_mesh_files(arguments.out, arguments.parts), arguments.json);
  if (cloud->parsed()) {
    return finish(write_depth_cloud(arguments.cloud, arguments.cloud_options, arguments.out), arguments.json);
  }
  if (table->parsed()) return finish(print_table(arguments.root, arguments.plan));
  if (ablation->parsed()) return finish(print_ablation(arguments.root, arguments.configs, arguments.plan));
  std::optional<MeshAlignment> alignment;
  if (*estimate) alignment = MeshAlignment{arguments.trajectory, arguments.groundtruth};
  return finish(report_mesh(arguments.estimate, arguments.reference, alignment), arguments.json);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "egraph-eval: %s\n", exception.what());
    return 1;
  }
}
