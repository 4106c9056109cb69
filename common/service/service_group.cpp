#include "common/service/service_group.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "common/io/atomic_file.hpp"

namespace eg::service {
namespace {

/// Prefixes also name folders, and must not lead out of the one they are in.
base::Status check_robots(const std::vector<std::string>& robots) {
  for (auto robot = robots.begin(); robot != robots.end(); ++robot) {
    const std::string text = "robot '" + *robot + "'";
    if (robot->empty()) return base::fail("a robot needs a channel prefix, not an empty one");
    if (robot->front() == '.' || robot->find('/') != std::string::npos) {
      return base::fail(text + ": the prefix also names a folder, so no '/' in it and no dot in front");
    }
    if (std::find(robots.begin(), robot, *robot) != robot) return base::fail(text + " is there twice");
    if (const auto name = transport::ChannelPrefix(*robot).add("X"); !name) return tl::make_unexpected(name.error());
  }
  return {};
}

}  // namespace

base::Result<std::unique_ptr<ServiceGroup>> ServiceGroup::make(transport::Bus& bus, const ServiceProgram& program,
                                                               const ServiceOptions& options) {
  if (const auto sound = check_robots(program.robots); !sound) return tl::make_unexpected(sound.error());
  auto group = std::make_unique<ServiceGroup>();
  if (program.robots.empty()) {
    if (const auto added = group->add(bus, program, options); !added) return tl::make_unexpected(added.error());
  }
  for (const std::string& robot : program.robots) {
    ServiceOptions of_robot = options;
    of_robot.robot = robot;
    if (!options.out.empty()) of_robot.out = options.out / robot;
    if (const auto added = group->add(bus, program, of_robot); !added) {
      return base::fail("robot '" + robot + "': " + added.error().message);
    }
  }
  return group;
}

base::Status ServiceGroup::add(transport::Bus& bus, const ServiceProgram& program, const ServiceOptions& options) {
  if (!options.out.empty()) {
    std::error_code failure;
    std::filesystem::create_directories(options.out, failure);
    if (failure) return base::fail("cannot make the folder " + options.out.string() + ": " + failure.message());
    if (const auto writable = io::check_writable(options.out); !writable) return writable;
  }
  auto member = std::make_unique<Member>(bus, options);
  auto service = program.make(member->context);
  if (!service) return tl::make_unexpected(service.error());
  member->service = *std::move(service);
  member->loop = std::make_unique<ServiceLoop>(member->bus, member->context, *member->service);
  members_.push_back(std::move(member));
  return {};
}

base::Status ServiceGroup::step(std::chrono::milliseconds timeout) {
  for (const auto& member : members_) {
    if (const base::Status step = member->loop->step(std::exchange(timeout, {})); !step) return step;
  }
  return {};
}

bool ServiceGroup::ended() const {
  return std::all_of(members_.begin(), members_.end(), [](const auto& member) { return member->loop->ended(); });
}

base::Status ServiceGroup::save() {
  base::Status all;
  for (const auto& member : members_) {
    const base::Status saved = member->loop->save();
    if (!saved && all) all = saved;
  }
  return all;
}

void ServiceGroup::say_goodbye() {
  for (const auto& member : members_) member->loop->say_goodbye();
}

}  // namespace eg::service
