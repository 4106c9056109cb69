#include "services/frame_source/openni/openni_camera.hpp"

#include <OpenNI.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <utility>

#include "services/frame_source/image_pairer.hpp"

namespace eg::services {
namespace {

using messages::bot::ImageKind;
using messages::bot::Images;

std::int64_t now_utime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

constexpr int kManyUnpaired = 200;  ///< images: more than three seconds of two streams

/// OpenNI2 tells in a text of its own what went wrong last, with tabs and line breaks around it.
tl::unexpected<base::Error> failed(const std::string& what) {
  std::string why = openni::OpenNI::getExtendedError();
  std::erase_if(why, [](char c) { return c == '\n' || c == '\t'; });
  return base::fail(why.empty() ? what : what + ": " + why);
}

/// A device with its two streams. It is never taken apart: drivers go on in threads of their own after a stream was
/// stopped (that of Debian's dummy device crashes otherwise), and the camera goes with the process anyway.
struct Streams {
  openni::Device device;
  openni::VideoStream colour;
  openni::VideoStream depth;
};

class OpenNiCamera : public CameraDevice {
 public:
  OpenNiCamera(Streams& streams, const geometry::CameraModel& camera)
      : streams_(streams), camera_(camera), pairer_(static_cast<std::int64_t>(0.5e6 / camera.fps)) {}
  ~OpenNiCamera() override {
    streams_.colour.stop();
    streams_.depth.stop();
  }

  base::Result<std::optional<Images>> read(std::chrono::milliseconds timeout) override {
    std::array<openni::VideoStream*, 2> streams = {&streams_.colour, &streams_.depth};
    int ready = 0;
    const auto waited = openni::OpenNI::waitForAnyStream(streams.data(), static_cast<int>(streams.size()), &ready,
                                                         static_cast<int>(timeout.count()));
    if (waited == openni::STATUS_TIME_OUT) return std::optional<Images>();
    openni::VideoFrameRef frame;
    if (waited != openni::STATUS_OK ||
        streams[static_cast<std::size_t>(ready)]->readFrame(&frame) != openni::STATUS_OK) {
      return failed(name() + " gives no more images");
    }
    const bool is_depth = ready == 1;
    const auto device_utime = static_cast<std::int64_t>(frame.getTimestamp());
    if (!clock_offset_) clock_offset_ = now_utime() - device_utime;
    auto pair = pairer_.add(image_of(frame, is_depth), device_utime + *clock_offset_);
    unpaired_ = pair ? 0 : unpaired_ + 1;
    if (unpaired_ == kManyUnpaired) {
      spdlog::warn("{}: of the last {} images no two were taken at once, in colour and in depth: none is used", name(),
                   kManyUnpaired);
    }
    return pair;
  }

  [[nodiscard]] std::string description() const override {
    return name() + " through OpenNI2, " + std::to_string(camera_.width) + " x " + std::to_string(camera_.height) +
           ", camera " + camera_.name;
  }

 private:
  [[nodiscard]] std::string name() const {
    const openni::DeviceInfo& info = streams_.device.getDeviceInfo();
    return std::string(info.getVendor()) + " " + info.getName() + " (" + info.getUri() + ")";
  }

  static Images::Image image_of(const openni::VideoFrameRef& frame, bool is_depth) {
    const auto* data = static_cast<const std::uint8_t*>(frame.getData());
    return {is_depth ? ImageKind::depth_mm : ImageKind::left,
            frame.getWidth(),
            frame.getHeight(),
            frame.getStrideInBytes(),
            is_depth ? 0 : messages::bot::kPixelFormatRgb,
            {data, data + frame.getDataSize()}};
  }

  Streams& streams_;
  geometry::CameraModel camera_;
  ImagePairer pairer_;
  std::optional<std::int64_t> clock_offset_;  ///< microseconds from the device's clock to this machine's
  int unpaired_ = 0;                          ///< images since the last pair
};

/// What a stream begins with is often right already, and some devices refuse to be told anything.
bool is_in(const openni::VideoStream& stream, const openni::VideoMode& mode) {
  const openni::VideoMode now = stream.getVideoMode();
  return now.getResolutionX() == mode.getResolutionX() && now.getResolutionY() == mode.getResolutionY() &&
         now.getFps() == mode.getFps() && now.getPixelFormat() == mode.getPixelFormat();
}

base::Status set_up(openni::VideoStream& stream, const openni::Device& device, openni::SensorType sensor,
                    openni::PixelFormat format, const geometry::CameraModel& camera) {
  const std::string name = sensor == openni::SENSOR_DEPTH ? "depth stream" : "colour stream";
  openni::VideoMode mode;
  mode.setResolution(camera.width, camera.height);
  mode.setFps(static_cast<int>(std::lround(camera.fps)));
  mode.setPixelFormat(format);
  if (stream.create(device, sensor) != openni::STATUS_OK) return failed("the device has no " + name);
  if (!is_in(stream, mode) && stream.setVideoMode(mode) != openni::STATUS_OK) {
    return failed("the " + name + " has no mode of " + std::to_string(camera.width) + " x " +
                  std::to_string(camera.height) + " pixels at " + std::to_string(mode.getFps()) +
                  " per second, as --camera asks for");
  }
  stream.setMirroringEnabled(false);  // which devices that cannot mirror refuse
  return {};
}

/// Depth as the colour camera sees it, both taken at once: as far as the device can do that.
void align(openni::Device& device) {
  constexpr auto kDepthToColour = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  if (device.isImageRegistrationModeSupported(kDepthToColour)) {
    device.setImageRegistrationMode(kDepthToColour);
  } else {
    spdlog::warn("this camera does not register depth to colour: the images must lie on one another as they are");
  }
  device.setDepthColorSyncEnabled(true);
}

}  // namespace

base::Result<std::unique_ptr<CameraDevice>> open_openni_camera(const std::string& uri,
                                                               const geometry::CameraModel& camera) {
  const std::string about = "camera '" + uri + "'";
  if (openni::OpenNI::initialize() != openni::STATUS_OK) return failed(about + ": OpenNI2 cannot be used");
  static auto* const streams = new Streams;  // never deleted, see there
  if (streams->device.open(uri == "any" ? openni::ANY_DEVICE : uri.c_str()) != openni::STATUS_OK) {
    return failed(about + " cannot be opened");
  }
  align(streams->device);
  for (const base::Status& ready :
       {set_up(streams->colour, streams->device, openni::SENSOR_COLOR, openni::PIXEL_FORMAT_RGB888, camera),
        set_up(streams->depth, streams->device, openni::SENSOR_DEPTH, openni::PIXEL_FORMAT_DEPTH_1_MM, camera)}) {
    if (!ready) return base::fail(about + ": " + ready.error().message);
  }
  // One right after the other: some devices count each stream's time from its start.
  for (openni::VideoStream* stream : {&streams->colour, &streams->depth}) {
    if (stream->start() != openni::STATUS_OK) return failed(about + ": its streams cannot be started");
  }
  return std::make_unique<OpenNiCamera>(*streams, camera);
}

}  // namespace eg::services
