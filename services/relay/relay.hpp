#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/transport/bus.hpp"

namespace eg::relay {

/// Which channels pass, and in which direction. A bus hears itself: what passed both ways would go round for ever.
struct Channels {
  std::vector<std::string> out;  ///< from the robot's own bus to the shared one
  std::vector<std::string> in;   ///< from the shared bus to the robot's own
};

/// What a robot and the E-Graph server, viewers and libbot2's programs say to one another; images and features stay.
Channels default_channels();

/// Refuses a channel that is there twice, naming it.
base::Status validate(const Channels& channels);

/// Passes messages between two buses as they are: what a robot says to others goes out, what others say to it comes in,
/// the rest (images, features, lockstep) stays where it is.
class Relay {
 public:
  /// The buses outlive it.
  Relay(transport::Bus& own, transport::Bus& shared) : own_(own), shared_(shared) {}

  /// Once. The error is the bus's, or names a channel that is there twice.
  base::Status start(const Channels& channels);

  /// Passes on what has come; waits at most `timeout` for more on each side. An error: a bus has ended.
  base::Status step(std::chrono::milliseconds timeout);

  struct Traffic {
    std::int64_t messages = 0;
    std::int64_t bytes = 0;
  };
  /// What has passed so far, by channel.
  [[nodiscard]] const std::map<std::string, Traffic>& traffic() const { return traffic_; }
  [[nodiscard]] std::int64_t lost() const { return lost_; }  ///< messages that the other bus did not take

 private:
  base::Status pass(transport::Bus& from, transport::Bus& to, const std::string& channel);

  transport::Bus& own_;
  transport::Bus& shared_;
  std::map<std::string, Traffic> traffic_;
  std::int64_t lost_ = 0;
};

}  // namespace eg::relay
