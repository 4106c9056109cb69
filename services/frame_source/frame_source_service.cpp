#include "services/frame_source/frame_source_service.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <thread>
#include <utility>

#include "common/io/trajectory_file.hpp"
#include "common/messages/channels.hpp"

namespace eg::services {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kFramesAhead = 2;
constexpr milliseconds kPatience{10};          // for a frame that is still being read
constexpr std::int64_t kSleepAtMost = 20'000;  // microseconds that idle() may wait for a frame's time
constexpr int kSkippedAtOnce = 10;             // of what a source before this one has sent, between messages
constexpr std::int64_t kEndPeriod = 200'000;   // microseconds between END_OF_STREAM messages

}  // namespace

base::Status validate(const FrameSourceOptions& options, bool lockstep) {
  if (lockstep && options.consumers.empty()) {
    return base::fail("lockstep needs the names of the services that acknowledge frames (--consumers)");
  }
  return {};
}

FrameSourceService::FrameSourceService(service::ServiceContext& context, const FrameSourceOptions& options,
                                       std::unique_ptr<FrameInput> input)
    : context_(context),
      session_(options.input.session.value_or(input->session())),
      input_(std::move(input)),
      window_(options.consumers, options.window),
      pacer_(options.consumers),
      store_(kFramesStored),
      skipped_utimes_(input_->skipped_utimes()),
      reader_(input_, kFramesAhead) {
  context_.status().set_state("waiting for consumers");
  spdlog::info("{}", input_->description());
  if (context_.options().lockstep) {
    context_.subscribe<messages::Acknowledge>(
        messages::channels::kAcknowledge, service::kSmallQueue, [this](const messages::Acknowledge& acknowledge) {
          if (acknowledge.session != session_) return;
          window_.acknowledge(acknowledge.consumer, acknowledge.sequence, now_utime_);
        });
  } else {
    context_.subscribe<messages::ServiceStatus>(
        messages::channels::kStatus, service::kSmallQueue,
        [this](const messages::ServiceStatus& status) { pacer_.heard_of(status.service); });
    context_.subscribe<messages::ResendRequest>(
        messages::channels::kResend, kRequestQueue, [this](const messages::ResendRequest& request) {
          if (request.session == session_ && request.channel == messages::channels::kRgbd) store_.request(request);
        });
  }
}

void FrameSourceService::idle(std::int64_t now_utime) {
  now_utime_ = now_utime;
  if (context_.options().lockstep) {
    run_lockstep(now_utime);
  } else {
    run_realtime(now_utime);
  }
  if (reader_.exhausted() && !waiting_ && window_.empty()) announce_end(now_utime);
}

void FrameSourceService::run_lockstep(std::int64_t now_utime) {
  for (int skipped = 0; window_.has_room() && skipped < kSkippedAtOnce;) {
    std::optional<SourceFrame> frame = next_frame();
    if (!frame) break;
    if (window_.is_done(header_of(*frame).sequence)) {
      sent_ = header_of(*frame).sequence + 1;
      ++skipped;
      continue;
    }
    send(*frame);
    window_.add(*std::move(frame), now_utime);
  }
  if (const SourceFrame* lost = window_.to_resend(now_utime)) {
    publish(*lost);
  }
}

void FrameSourceService::run_realtime(std::int64_t now_utime) {
  if (const SourceFrame* frame = store_.next()) publish(*frame);  // one a round: new frames go first
  if (!waiting_) waiting_ = next_frame();
  if (!waiting_) return;
  const std::optional<std::int64_t> until_due = pacer_.until(header_of(*waiting_).utime, now_utime);
  if (!until_due || *until_due > kSleepAtMost) return;
  if (*until_due > 0) std::this_thread::sleep_for(microseconds(*until_due));
  send(*waiting_);
  store_.add(*std::move(waiting_));
  waiting_.reset();
}

std::optional<SourceFrame> FrameSourceService::next_frame() {
  while (std::optional<ReadAhead::Item> item = reader_.take(kPatience)) {
    if (item->frame) {
      header_of(*item->frame) = {session_, sent_, input_->utime(item->index)};
      return *std::move(item->frame);
    }
    spdlog::warn("frame {} is skipped: {}", item->index, item->frame.error().message);
    skipped_utimes_.push_back(input_->utime(item->index));
  }
  return std::nullopt;
}

void FrameSourceService::send(const SourceFrame& frame) {
  const auto start = steady_clock::now();
  publish(frame);
  context_.status().set_state("sending");
  context_.status().count_frame(std::chrono::duration<double, std::milli>(steady_clock::now() - start).count());
  sent_ = header_of(frame).sequence + 1;
}

void FrameSourceService::publish(const SourceFrame& frame) {
  if (const auto* images = std::get_if<messages::CompressedFrame>(&frame)) {
    context_.publish(messages::channels::kRgbd, *images);
  } else {
    context_.publish(messages::channels::kFeatures, std::get<features::FrameFeatures>(frame));
  }
}

void FrameSourceService::announce_end(std::int64_t now_utime) {
  if (end_announced_ && now_utime - *end_announced_ < kEndPeriod) return;
  if (!end_announced_) {
    context_.status().set_state("end of stream");
    spdlog::info("{} frames sent, {} skipped", sent_, skipped_utimes_.size());
  }
  end_announced_ = now_utime;
  context_.publish(messages::channels::kEndOfStream, messages::EndOfStream{session_, sent_, skipped_utimes_});
}

base::Status FrameSourceService::save() {
  const std::vector<geometry::StampedPose> poses = input_->ground_truth();
  if (context_.options().out.empty() || poses.empty()) return {};
  return io::write_trajectory(context_.options().out / "groundtruth.txt", poses);
}

}  // namespace eg::services
