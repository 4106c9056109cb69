#pragma once

#include <cstdint>

#include "common/synthetic/scene.hpp"

/// The scenes behind make_scene(), one file each.
namespace eg::synthetic {

Scene make_room(std::uint64_t seed);
Scene make_slanted(std::uint64_t seed);
Scene make_corridor(std::uint64_t seed);
Scene make_corner(std::uint64_t seed);

}  // namespace eg::synthetic
