#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/messages/bot_images.hpp"
#include "common/service/service.hpp"
#include "services/frame_source/camera_reader.hpp"
#include "services/frame_source/frame_store.hpp"

namespace eg::services {

struct LiveSourceOptions {
  std::string channel = "OPENNI_FRAME";  ///< of bot_core.images_t; with a device: what to call it in reports
  geometry::CameraModel camera;
  std::int64_t session = 1;
};

/// Takes the images of a live camera (bot_core.images_t, or a device at this machine) and publishes them as RGBD: a
/// colour image in JPEG as it is, depth compressed without loss. Real time only. The frames of the last ten seconds are
/// sent again to who asks for them. END_OF_STREAM when the service is stopped. One that was killed and is started again
/// goes on behind the numbers that the tracker has had, which it learns from the answer to its first frame.
class LiveSourceService : public service::Service {
 public:
  /// `device`: null: images come over the channel. An error of the device comes out of idle() as an exception.
  LiveSourceService(service::ServiceContext& context, LiveSourceOptions options,
                    std::unique_ptr<CameraDevice> device = nullptr);

  void idle(std::int64_t now_utime) override;
  base::Status save() override;

 private:
  void on_images(const messages::bot::Images& images);
  void read_camera();

  service::ServiceContext& context_;
  LiveSourceOptions options_;
  FrameStore store_;
  std::unique_ptr<CameraReader> reader_;
  std::int64_t sent_ = 0;
  std::int64_t last_utime_ = -1;
};

}  // namespace eg::services
