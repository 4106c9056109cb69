#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "services/log/extract.hpp"
#include "services/log/log_summary.hpp"

namespace {

using namespace eg::log_tool;

int report(const eg::base::Error& error) {
  std::fprintf(stderr, "egraph-log: %s\n", error.message.c_str());
  return 1;
}

/// Says what was extracted, or why it could not be; returns the exit code.
int report(const eg::base::Result<std::int64_t>& count, const char* what, const std::filesystem::path& where) {
  if (!count) return report(count.error());
  std::printf("%lld %s in %s\n", static_cast<long long>(*count), what, where.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path log, images, poses, features;
  Selection selection;
  bool as_json = false;
  CLI::App app("Lists what an LCM log holds, or takes images, poses or features out of it", "egraph-log");
  app.add_option("LOG", log, "File that lcm-logger or egraph-run --log wrote")->required();
  app.add_flag("--json", as_json, "List as JSON");
  app.add_option("--images", images, "Folder to write the colour and depth images to, as a data set in TUM layout");
  app.add_option("--poses", poses, "File to write the poses to, in TUM format");
  app.add_option("--features", features, "File to write the features to, as CSV");
  app.add_option("--channel-prefix", selection.channel_prefix, "Of the channels to extract from");
  app.add_option("--session", selection.session, "Session to extract, if there are several");
  CLI11_PARSE(app, argc, argv);

  try {
    int failures = 0;
    if (!images.empty()) failures += report(extract_images(log, selection, images), "frames", images);
    if (!poses.empty()) failures += report(extract_poses(log, selection, poses), "poses", poses);
    if (!features.empty()) failures += report(extract_features(log, selection, features), "features", features);
    if (!images.empty() || !poses.empty() || !features.empty()) return failures == 0 ? 0 : 1;
    const auto summary = summarise(log);
    if (!summary) return report(summary.error());
    std::fputs((as_json ? format_json(*summary) : format_table(*summary)).c_str(), stdout);
    return summary->damaged_places == 0 ? 0 : 2;
  } catch (const std::exception& exception) {
    return report({exception.what()});
  }
}
