#pragma once

namespace eg::geometry {

/// Standard deviation in metres of one depth reading of a structured-light camera at depth `z` metres: a fixed part and
/// a part that grows with z² (Nguyen, Izadi, Lovell, 3DIMPVT 2012, their equation for the axial noise; Khoshelham and
/// Elberink, Sensors 2012, derive the z² from disparity). Every threshold on depth in this project comes from it.
inline constexpr double kDepthSigmaFixed = 0.0012;   // metres
inline constexpr double kDepthSigmaGrowth = 0.0019;  // 1/m
inline constexpr double kDepthSigmaNearest = 0.4;    // metres
inline double depth_sigma(double z) {
  const double beyond = z - kDepthSigmaNearest;
  return kDepthSigmaFixed + kDepthSigmaGrowth * beyond * beyond;
}

}  // namespace eg::geometry
