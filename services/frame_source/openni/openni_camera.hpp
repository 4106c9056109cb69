#pragma once

#include <memory>
#include <string>

#include "common/geometry/camera_model.hpp"
#include "services/frame_source/camera_device.hpp"

namespace eg::services {

/// Opens a camera through OpenNI2: `uri` as OpenNI2 names it, or "any" for the first one that is found. Streams have
/// the size and rate of `camera`; depth is in millimetres, seen from the colour camera where the device can do that.
/// The error names what is missing, also where this program was built without OpenNI2.
base::Result<std::unique_ptr<CameraDevice>> open_openni_camera(const std::string& uri,
                                                               const geometry::CameraModel& camera);

}  // namespace eg::services
