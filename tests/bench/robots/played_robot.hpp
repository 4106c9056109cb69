#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "common/messages/codec.hpp"
#include "common/transport/prefixed_bus.hpp"

namespace eg::bench {

using Clock = std::chrono::steady_clock;

/// What one robot says in a run: its keyframes, and how large the messages of its other streams are.
struct RecordedRobot {
  struct Announcement {
    Clock::duration when{};  ///< since the first keyframe was taken
    std::int64_t keyframe = 0;
    messages::Bytes message;  ///< KEYFRAME as it was sent
  };
  struct Stream {
    std::string channel;
    std::size_t bytes = 0;  ///< of a message, on average
  };

  std::vector<Announcement> announcements;
  std::vector<Stream> streams;
};

/// A robot that repeats a recording in real time under a channel prefix of its own. It announces every keyframe until
/// the server has answered it, as the tracker does, and sends 30 messages a second on each stream.
class PlayedRobot {
 public:
  /// Begins at `start`. `bus` and `recorded` outlive it.
  PlayedRobot(transport::Bus& bus, std::string prefix, const RecordedRobot& recorded, Clock::time_point start);
  PlayedRobot(const PlayedRobot&) = delete;
  PlayedRobot& operator=(const PlayedRobot&) = delete;

  /// Sends what is due.
  void step(Clock::time_point now);

  [[nodiscard]] const std::vector<double>& answers_ms() const { return answers_ms_; }  ///< from announced to answered
  [[nodiscard]] std::size_t announced() const { return next_; }
  [[nodiscard]] std::size_t unanswered() const { return waiting_.size(); }
  [[nodiscard]] std::size_t repeated() const { return repeated_; }

 private:
  struct Waiting {
    const RecordedRobot::Announcement* announcement;
    Clock::time_point first_sent;
    Clock::time_point last_sent;
  };

  void on_update(messages::ByteView bytes);
  void send(const char* channel, messages::ByteView bytes);

  transport::PrefixedBus bus_;
  const RecordedRobot& recorded_;
  Clock::time_point start_;
  Clock::time_point next_frame_;
  std::size_t next_ = 0;
  std::size_t repeated_ = 0;
  std::deque<Waiting> waiting_;
  std::vector<double> answers_ms_;
};

}  // namespace eg::bench
