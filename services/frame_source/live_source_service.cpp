#include "services/frame_source/live_source_service.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "common/messages/channels.hpp"

namespace eg::services {
namespace {

constexpr int kQueue = 2;  // what waits longer is out of date

}  // namespace

LiveSourceService::LiveSourceService(service::ServiceContext& context, LiveSourceOptions options,
                                     std::unique_ptr<CameraDevice> device)
    : context_(context), options_(std::move(options)), store_(kFramesStored) {
  context_.status().set_state("waiting for a camera");
  if (device) {
    reader_ = std::make_unique<CameraReader>(std::move(device));
  } else {
    context_.subscribe<messages::bot::Images>(options_.channel.c_str(), kQueue,
                                              [this](const messages::bot::Images& images) { on_images(images); });
  }
  context_.subscribe<messages::Acknowledge>(messages::channels::kAcknowledge, service::kSmallQueue,
                                            [this](const messages::Acknowledge& acknowledge) {
                                              if (acknowledge.session == options_.session)
                                                sent_ = std::max(sent_, acknowledge.sequence + 1);
                                            });
  context_.subscribe<messages::ResendRequest>(
      messages::channels::kResend, kRequestQueue, [this](const messages::ResendRequest& request) {
        if (request.session == options_.session && request.channel == messages::channels::kRgbd)
          store_.request(request);
      });
}

void LiveSourceService::on_images(const messages::bot::Images& images) {
  const auto start = std::chrono::steady_clock::now();
  auto frame = messages::bot::to_frame(images, options_.camera);
  if (!frame) return context_.status().count_rejected(options_.channel + ": " + frame.error().message);
  if (frame->header.utime <= last_utime_) {
    return context_.status().count_rejected(options_.channel +
                                            ": field 'utime' does not lead on from the frame before");
  }
  last_utime_ = frame->header.utime;
  frame->header.session = options_.session;
  frame->header.sequence = sent_++;
  context_.publish(messages::channels::kRgbd, *frame);
  store_.add(*std::move(frame));
  context_.status().set_state("sending");
  context_.status().count_frame(
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
}

void LiveSourceService::idle(std::int64_t /*now_utime*/) {
  if (reader_) read_camera();
  // One a round: new frames go first.
  if (const SourceFrame* frame = store_.next()) {
    context_.publish(messages::channels::kRgbd, std::get<messages::CompressedFrame>(*frame));
  }
}

void LiveSourceService::read_camera() {
  while (true) {
    const auto images = reader_->take();
    if (!images) throw std::runtime_error(images.error().message);
    if (!images->has_value()) return;
    on_images(**images);
  }
}

base::Status LiveSourceService::save() {
  context_.publish(messages::channels::kEndOfStream, messages::EndOfStream{options_.session, sent_, {}});
  return {};
}

}  // namespace eg::services
