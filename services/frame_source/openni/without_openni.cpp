#include "services/frame_source/openni/openni_camera.hpp"

namespace eg::services {

base::Result<std::unique_ptr<CameraDevice>> open_openni_camera(const std::string& uri, const geometry::CameraModel&) {
  return base::fail("camera '" + uri +
                    "': this program was built without OpenNI2; install libopenni2-dev, configure and build again");
}

}  // namespace eg::services
