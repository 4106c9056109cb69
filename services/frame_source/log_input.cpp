#include "services/frame_source/log_input.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "common/recording/frame_log.hpp"

namespace eg::services {
namespace {

class LogInput : public FrameInput {
 public:
  LogInput(recording::FrameLog log, std::string name, std::int64_t max_frames)
      : log_(std::move(log)), name_(std::move(name)) {
    const auto frames = static_cast<std::int64_t>(log_.frames().size());
    size_ = max_frames > 0 ? std::min(frames, max_frames) : frames;
  }

  [[nodiscard]] std::int64_t size() const override { return size_; }
  [[nodiscard]] std::int64_t utime(std::int64_t index) const override {
    return log_.frames()[static_cast<std::size_t>(index)].utime;
  }
  [[nodiscard]] base::Result<SourceFrame> read(std::int64_t index) const override {
    auto frame = log_.read(static_cast<std::size_t>(index));
    // A consumer would reject damaged images and never acknowledge the frame: better to leave it out here.
    const auto images = frame.and_then(messages::decompress);
    if (!images) return base::fail(name_ + ": " + images.error().message);
    return SourceFrame(*std::move(frame));
  }
  [[nodiscard]] std::int64_t session() const override { return log_.session(); }
  [[nodiscard]] std::vector<std::int64_t> skipped_utimes() const override { return log_.skipped_utimes(); }
  [[nodiscard]] std::string description() const override {
    return name_ + ": " + std::to_string(size_) + " frames of session " + std::to_string(session()) + " on channel " +
           log_.channel() + ", camera " + log_.camera().name;
  }

 private:
  mutable recording::FrameLog log_;  // its place in the file moves
  std::string name_;
  std::int64_t size_ = 0;
};

}  // namespace

base::Result<std::unique_ptr<FrameInput>> open_log(const std::filesystem::path& file, const InputOptions& options) {
  auto log = recording::FrameLog::open(file, {options.log_channel, options.session});
  if (!log) return tl::make_unexpected(log.error());
  if (log->damage().any()) spdlog::warn("{}", recording::describe(log->damage()));
  return std::make_unique<LogInput>(*std::move(log), file.string(), options.max_frames);
}

}  // namespace eg::services
