#include "tests/system/distributed/fleet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>

#include "common/messages/channels.hpp"
#include "common/procman/process_tree.hpp"

namespace eg::test {
namespace {

constexpr char kUrl[] = "udpm://239.255.76.67:7995?ttl=1&recv_buf_size=2097152";

void set_environment(const Fleet::Options& options) {
  setenv("EGRAPH_DATASET", "synthetic:room", 1);
  setenv("EGRAPH_FRAMES", std::to_string(options.frames).c_str(), 1);
  setenv("EGRAPH_OUT", options.out.c_str(), 1);
  setenv("EGRAPH_LOCKSTEP", "1", 1);
  setenv("EGRAPH_CONSUMERS", "tracker,mapper", 1);
}

}  // namespace

Fleet::Fleet(const Hosts& hosts, const Options& options) : hosts_(hosts), options_(options) {
  set_environment(options);
  for (std::size_t i = 0; i < options.deputies.size(); ++i) {
    hosts_.enter(static_cast<int>(i));
    const std::string& name = options.deputies[i];
    deputies_[name] = std::make_unique<Program>(
        "procman-deputy", std::vector<std::string>{"--name", name, "--remote", "--lcm-url", kUrl});
  }
  hosts_.enter(0);
  auto bus = transport::LcmBus::create({kUrl, ""});
  EXPECT_TRUE(bus) << bus.error().message;
  bus_ = *std::move(bus);
  const auto note_end = [this](const transport::ReceivedMessage& /*message*/) { ended_ = true; };
  EXPECT_TRUE(bus_->subscribe(messages::channels::kEndOfStream, note_end, 1));
  const auto count_pose = [this](const transport::ReceivedMessage& /*message*/) { ++poses_; };
  EXPECT_TRUE(bus_->subscribe(messages::channels::kPose, count_pose, 0));
  sheriff_ = std::make_unique<Program>("procman-sheriff", sheriff_arguments("run"));
}

bool Fleet::wait_for_poses(int count, std::chrono::seconds limit) {
  const int wanted = poses_ + count;
  return handle_until([&] { return poses_ >= wanted; }, limit);
}

bool Fleet::wait_for_end(std::chrono::seconds limit) {
  return handle_until([this] { return ended_; }, limit);
}

bool Fleet::handle_until(const std::function<bool()>& condition, std::chrono::seconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition() && std::chrono::steady_clock::now() < end) {
    if (!bus_->handle(std::chrono::milliseconds(100))) return false;
  }
  return condition();
}

int Fleet::stop() {
  sheriff_->send_signal(SIGINT);
  sheriff_->wait();
  Program last("procman-sheriff", sheriff_arguments("stop"));
  return last.wait();
}

bool Fleet::kill_service(const std::string& program) {
  for (const procman::Process& process : procman::list_processes()) {
    const auto executable = "/proc/" + std::to_string(process.pid) + "/exe";
    std::error_code gone;
    const bool ours =
        std::filesystem::read_symlink(executable, gone) == std::filesystem::path(EGRAPH_BIN_DIR) / program;
    const auto descendants = procman::find_descendants(getpid());
    if (ours && std::find(descendants.begin(), descendants.end(), process.pid) != descendants.end()) {
      return kill(process.pid, SIGKILL) == 0;
    }
  }
  return false;
}

std::string Fleet::output() const {
  std::string all = sheriff_->output();
  for (const auto& [name, deputy] : deputies_) all += deputy->output();
  return all;
}

std::vector<std::string> Fleet::sheriff_arguments(const std::string& script) const {
  const std::string file = std::string(EGRAPH_SOURCE_DIR) + "/procman/" + options_.configuration;
  return {"--lcm-url", kUrl, "--on-script-complete", script == "stop" ? "exit" : "stay", file, script};
}

}  // namespace eg::test
