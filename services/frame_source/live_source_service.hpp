#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/messages/bot_images.hpp"
#include "common/service/service.hpp"
#include "services/frame_source/frame_store.hpp"

namespace eg::services {

struct LiveSourceOptions {
  std::string channel = "OPENNI_FRAME";  ///< of bot_core.images_t
  geometry::CameraModel camera;
  std::int64_t session = 1;
};

/// Takes the images of a live camera (bot_core.images_t) and publishes them as RGBD: a colour image in JPEG as it is,
/// depth compressed without loss. Real time only. The frames of the last ten seconds are sent again to who asks for
/// them. END_OF_STREAM when the service is stopped.
class LiveSourceService : public service::Service {
 public:
  LiveSourceService(service::ServiceContext& context, LiveSourceOptions options);

  void idle(std::int64_t now_utime) override;
  base::Status save() override;

 private:
  void on_images(const messages::bot::Images& images);

  service::ServiceContext& context_;
  LiveSourceOptions options_;
  FrameStore store_;
  std::int64_t sent_ = 0;
  std::int64_t last_utime_ = -1;
};

}  // namespace eg::services
