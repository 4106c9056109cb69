#include "common/mapping/depth_view.hpp"

namespace eg::mapping {

DepthView::DepthView(const image::RectifiedFrame& frame, const TsdfOptions& options)
    : width_(frame.camera.width),
      height_(frame.camera.height),
      continuity_(static_cast<float>(2.0 * options.voxel_size)),
      inverse_depth_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      colour_(frame.colour) {
  const auto nearest = static_cast<float>(options.min_depth);
  const auto farthest = static_cast<float>(options.max_depth);
  for (int y = 0; y < height_; ++y) {
    const auto* depth = frame.depth.ptr<float>(y);
    float* inverse = &inverse_depth_[index(0, y)];
    for (int x = 0; x < width_; ++x) {
      const bool usable = depth[x] >= nearest && depth[x] <= farthest;  // false for NaN
      inverse[x] = usable ? 1.0F / depth[x] : 0.0F;
    }
  }
}

}  // namespace eg::mapping
