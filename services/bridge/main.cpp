#include <memory>

#include "services/bridge/bridge_service.hpp"

int main(int argc, char** argv) {
  eg::service::ServiceProgram program;
  program.name = "bridge";
  program.description = "Says poses, keyframes and edges in the types of libbot2: bot_core and vs";
  program.make = [](eg::service::ServiceContext& context) {
    return std::make_unique<eg::services::BridgeService>(context);
  };
  return eg::service::run_service(program, argc, argv);
}
