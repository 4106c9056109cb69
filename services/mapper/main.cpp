#include <CLI/CLI.hpp>
#include <charconv>
#include <memory>
#include <string>

#include "common/service/logging.hpp"
#include "common/service/service.hpp"
#include "services/mapper/mapper_config.hpp"
#include "services/mapper/mapper_service.hpp"

namespace {

using namespace eg;

/// "0/2": the first of two shares.
base::Status parse_tiles(const std::string& text, mapping::TsdfOptions& options) {
  const char* const end = text.data() + text.size();
  const auto [slash, wrong_share] = std::from_chars(text.data(), end, options.share);
  if (wrong_share == std::errc{} && slash != end && *slash == '/') {
    const auto [last, wrong_shares] = std::from_chars(slash + 1, end, options.shares);
    if (wrong_shares == std::errc{} && last == end && options.share >= 0 && options.share < options.shares) return {};
  }
  return base::fail("--tiles: '" + text + "' is not I/N with 0 <= I < N");
}

base::Result<std::unique_ptr<service::Service>> make(service::ServiceContext& context, const std::string& tiles,
                                                     const std::string& archive, services::MapperOptions options) {
  if (const auto status = parse_tiles(tiles, options.tsdf); !status) return tl::make_unexpected(status.error());
  if (const auto status = mapping::validate(options.tsdf); !status) return tl::make_unexpected(status.error());
  auto mapper = std::make_unique<services::MapperService>(context, options);
  service::log_to_stderr(context.options().name);  // which of several it is
  if (const auto status = mapper->open(archive); !status) return tl::make_unexpected(status.error());
  return mapper;
}

}  // namespace

int main(int argc, char** argv) {
  services::MapperOptions options;
  std::string tiles = "0/1";
  std::string archive;
  service::ServiceProgram program;
  program.name = "mapper";
  program.description = "Fuses the depth images of keyframes into a coloured mesh";
  program.add_options = [&](CLI::App& app) {
    app.add_option("--tiles", tiles, "I/N: map the I-th of N shares of the space, from 0; other mappers do the others")
        ->envname("EGRAPH_TILES")
        ->capture_default_str();
    app.add_option("--load", archive, "Map archive (the --out of an earlier run) to go on in")->envname("EGRAPH_LOAD");
    app.add_flag("--resume", options.resume, "Go on from the journal that a killed mapper left in --out")
        ->envname("EGRAPH_RESUME");
  };
  program.configure = [&](io::ConfigSchema& section) { services::describe_options(section, options); };
  program.make = [&](service::ServiceContext& context) { return make(context, tiles, archive, options); };
  return service::run_service(program, argc, argv);
}
