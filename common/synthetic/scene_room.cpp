#include <array>
#include <numbers>

#include "common/base/random.hpp"
#include "common/synthetic/scene_builder.hpp"
#include "common/synthetic/scenes.hpp"

/// A living room of 6 x 5 x 2.6 m.
namespace eg::synthetic {
namespace {

constexpr double kHalfLength = 3.0;  // along x
constexpr double kHalfWidth = 2.5;   // along y
constexpr double kHeight = 2.6;
constexpr double kQuarterTurn = std::numbers::pi / 2.0;

enum Side : std::size_t { kFloor, kCeiling, kEast, kWest, kNorth, kSouth };

Material wood(std::uint32_t light, std::uint32_t dark, float board, std::uint32_t seed) {
  return {.texture = Texture::planks, .colour = srgb(light), .accent = srgb(dark), .scale = board, .seed = seed};
}

Material paint(std::uint32_t colour, float grain = 0.06F) { return {.colour = srgb(colour), .grain = grain}; }

/// Builds the room piece by piece; the seed varies what is painted.
class Room {
 public:
  explicit Room(std::uint64_t seed) : random_(seed) {}

  Scene make() {
    shell();
    shelves();
    sofa_corner();
    desk();
    door_and_gallery();
    coffee_table();
    ceiling();
    return build_.take();
  }

 private:
  std::uint32_t next_seed() { return static_cast<std::uint32_t>(random_.next() >> 32); }

  [[nodiscard]] geometry::Pose on(Side side, double u, double v) const {
    return mounted_at(build_.surface(side), u, v);
  }

  void shell() {
    const std::array<geometry::Plane, 6> planes = {{{Eigen::Vector3d::UnitZ(), 0.0},
                                                    {-Eigen::Vector3d::UnitZ(), kHeight},
                                                    {-Eigen::Vector3d::UnitX(), kHalfLength},
                                                    {Eigen::Vector3d::UnitX(), kHalfLength},
                                                    {-Eigen::Vector3d::UnitY(), kHalfWidth},
                                                    {Eigen::Vector3d::UnitY(), kHalfWidth}}};
    const Material plaster = {.texture = Texture::noise,
                              .colour = srgb(0xefe6d6),
                              .accent = srgb(0xe2d5bf),
                              .scale = 0.25F,
                              .grain = 0.05F,
                              .seed = next_seed()};
    Material green = plaster;
    green.colour = srgb(0x8fb3a8);
    green.accent = srgb(0x7ba396);
    const Material brick = {.texture = Texture::bricks,
                            .colour = srgb(0xb5654a),
                            .accent = srgb(0xd8cdbd),
                            .scale = 0.085F,
                            .grain = 0.25F,
                            .seed = next_seed()};
    const std::array<Material, 6> materials = {
        wood(0xc79a6b, 0x8f6238, 0.14F, next_seed()), paint(0xf4f1ea), green, brick, plaster, plaster};
    build_.interior(planes, materials);
    for (const Side side : {kEast, kWest, kNorth, kSouth}) build_.skirting(side, 0.09, 0.018, paint(0xfaf8f2));
  }

  void framed_picture(Side side, double u, double v, double width, double height, std::uint32_t frame_colour) {
    const auto extent = Eigen::Vector2f(static_cast<float>(width), static_cast<float>(height));
    build_.box(on(side, u, v), {0, -0.02, 0}, {width, 0, height}, kFront, picture(extent, 0.05F, next_seed()));
    build_.moulding(on(side, u, v), width, height, 0.03, 0.035, paint(frame_colour, 0.1F), true);
  }

  /// North wall: a wall unit with books, two pictures beside it.
  void shelves() {
    const geometry::Pose at = standing_at(-0.6, kHalfWidth, 0.0);
    const Material board = wood(0x9a7048, 0x6e4a2a, 0.4F, next_seed());
    build_.box(at, {-1.2, -0.4, 0.0}, {1.2, 0.0, 0.5}, kAgainstWall, board, board);
    for (const double side : {-1.2, -0.02, 1.16}) {
      build_.box(at, {side, -0.32, 0.5}, {side + 0.04, 0, 2.1}, kAgainstWall, board);
    }
    for (int row = 0; row < 5; ++row) {
      const double height = 0.5 + 0.395 * row;
      if (row > 0) build_.box(at, {-1.16, -0.3, height - 0.03}, {1.16, 0, height}, kFront | kTop | kBottom, board);
      if (row == 4) break;
      for (const double left : {-1.16, 0.02}) {
        const Material spines = {
            .texture = Texture::books, .accent = srgb(0x4a3320), .scale = 0.048F, .seed = next_seed()};
        build_.box(at, {left, -0.24, height}, {left + 1.14, 0, height + 0.365}, kFront, spines);
      }
    }
    for (const double left : {-1.17, -0.38, 0.41}) {  // drawers
      build_.box(at, {left, -0.42, 0.06}, {left + 0.76, -0.4, 0.46}, kHanging, board);
      build_.box(at, {left + 0.3, -0.44, 0.3}, {left + 0.46, -0.42, 0.33}, kHanging, paint(0x2f2a26));
    }
    framed_picture(kNorth, 4.0, 1.25, 0.6, 0.8, 0x2b2622);
    framed_picture(kNorth, 4.95, 1.25, 0.6, 0.8, 0x2b2622);
    build_.box(standing_at(2.1, kHalfWidth, 0.0), {-0.5, -0.38, 0.0}, {0.5, 0, 0.75}, kAgainstWall,
               wood(0xe0c9a0, 0xbfa172, 0.25F, next_seed()));
    build_.box(standing_at(1.9, kHalfWidth - 0.2, 0.3), {-0.12, -0.12, 0.75}, {0.12, 0.12, 1.02}, kStanding,
               Material{.texture = Texture::tiles, .colour = srgb(0xf2efe6), .accent = srgb(0x31708e), .scale = 0.06F});
  }

  /// West wall, of brick: a sofa with cushions under a large picture, a side table with a lamp.
  void sofa_corner() {
    const geometry::Pose at = standing_at(-kHalfLength, -0.2, kQuarterTurn);
    const Material cloth = {.texture = Texture::noise,
                            .colour = srgb(0x3f6173),
                            .accent = srgb(0x2f4d5e),
                            .scale = 0.03F,
                            .grain = 0.3F,
                            .seed = next_seed()};
    build_.box(at, {-1.0, -0.85, 0.08}, {1.0, -0.2, 0.42}, kAgainstWall, cloth);
    build_.box(at, {-1.0, -0.22, 0.08}, {1.0, 0, 0.85}, kAgainstWall, cloth);
    for (const double left : {-1.18, 1.0}) {
      build_.box(at, {left, -0.88, 0.08}, {left + 0.18, 0, 0.6}, kAgainstWall, cloth);
    }
    for (const double left : {-0.9, 0.35}) {
      geometry::Pose cushion = at;
      cushion.translation = at * Eigen::Vector3d(left, -0.42, 0.43);
      const Material cover = rug({0.48F, 0.4F}, next_seed());
      build_.box(cushion, {0, 0, 0}, {0.48, 0.14, 0.4}, kStanding, paint(0xd9a441, 0.2F), cover);
    }
    framed_picture(kWest, 1.6, 1.2, 1.4, 0.85, 0xe8e2d4);
    const geometry::Pose table = standing_at(-kHalfLength + 0.3, 1.45, kQuarterTurn);
    build_.box(table, {-0.22, -0.22, 0}, {0.22, 0.22, 0.5}, kStanding, wood(0xb58a5c, 0x8a6238, 0.11F, next_seed()));
    build_.box(table, {-0.03, -0.03, 0.5}, {0.03, 0.03, 0.75}, kStanding, paint(0x2f2a26));
    const Material shade = {.colour = srgb(0xf7e3b5), .grain = 0.05F, .glow = 0.45F};
    build_.box(table, {-0.15, -0.15, 0.75}, {0.15, 0.15, 1.0}, kAllFaces, shade);
  }

  /// East wall: a window above a desk with a monitor, books and a chair.
  void desk() {
    const Material white = paint(0xfaf8f2);
    const geometry::Pose window = on(kEast, 1.6, 0.95);
    const Material sky = {.texture = Texture::noise,
                          .colour = srgb(0xcfe6f5),
                          .accent = srgb(0x9cc7e6),
                          .scale = 0.5F,
                          .grain = 0.0F,
                          .seed = next_seed(),
                          .glow = 0.35F};
    build_.box(window, {0, -0.004, 0}, {1.8, 0, 1.25}, kFront, sky);
    build_.moulding(window, 1.8, 1.25, 0.07, 0.05, white, true);
    for (const double x : {0.58, 1.18}) build_.box(window, {x, -0.03, 0}, {x + 0.045, 0, 1.25}, kHanging, white);
    build_.box(window, {0, -0.03, 0.8}, {1.8, 0, 0.84}, kHanging, white);

    const geometry::Pose at = standing_at(kHalfLength, 0.0, -kQuarterTurn);
    const Material top = wood(0xd8b483, 0xb58a55, 0.3F, next_seed());
    build_.box(at, {-0.8, -0.65, 0.68}, {0.8, -0.03, 0.72}, kAllFaces, top);
    for (const double x : {-0.78, 0.73}) {
      for (const double y : {-0.62, -0.11}) {
        build_.box(at, {x, y, 0}, {x + 0.05, y + 0.05, 0.68}, kStanding, paint(0x3a3633));
      }
    }
    const Material screen = picture({0.56F, 0.33F}, 0.0F, next_seed());
    build_.box(at, {-0.3, -0.25, 0.8}, {0.3, -0.21, 1.17}, kAllFaces, paint(0x22242a), paint(0x22242a));
    build_.box(at, {-0.28, -0.252, 0.82}, {0.28, -0.25, 1.15}, kFront, screen);
    build_.box(at, {-0.04, -0.24, 0.72}, {0.04, -0.2, 0.8}, kStanding, paint(0x22242a));
    build_.box(at, {-0.2, -0.52, 0.72}, {0.2, -0.38, 0.74}, kStanding,
               Material{.texture = Texture::tiles, .colour = srgb(0x3b3f46), .accent = srgb(0x4a4f57), .scale = 0.02F});
    const std::array<std::uint32_t, 3> covers = {0x8c2f39, 0x2a9d8f, 0xe9c46a};
    for (std::size_t i = 0; i < covers.size(); ++i) {
      const double low = 0.72 + 0.04 * static_cast<double>(i);
      build_.box(standing_at(kHalfLength - 0.35, -0.55, 0.25 * static_cast<double>(i)), {-0.1, -0.14, low},
                 {0.1, 0.14, low + 0.04}, kStanding, paint(covers[i], 0.1F));
    }
    chair(standing_at(2.25, 0.75, kQuarterTurn + 0.5));
    build_.box(standing_at(kHalfLength - 0.2, 2.0, -kQuarterTurn), {-0.2, -0.2, 0}, {0.2, 0.2, 0.3}, kStanding,
               Material{.texture = Texture::tiles, .colour = srgb(0xd98e5a), .accent = srgb(0xf2e3c9), .scale = 0.1F});
  }

  void chair(const geometry::Pose& at) {
    const Material beech = wood(0xe0b884, 0xc79a62, 0.1F, next_seed());
    build_.box(at, {-0.22, -0.22, 0.42}, {0.22, 0.22, 0.46}, kAllFaces, beech);
    for (const double x : {-0.22, 0.18}) {
      build_.box(at, {x, -0.22, 0}, {x + 0.04, -0.18, 0.42}, kStanding, beech);
      build_.box(at, {x, 0.18, 0}, {x + 0.04, 0.22, 0.88}, kStanding, beech);
    }
    build_.box(at, {-0.18, 0.19, 0.68}, {0.18, 0.21, 0.86}, kAllFaces, beech);
  }

  /// South wall: a panelled door, a gallery of pictures, a low cabinet.
  void door_and_gallery() {
    const geometry::Pose door = on(kSouth, 0.6, 0.0);
    const Material leaf = wood(0xb98d5e, 0xa27848, 0.45F, next_seed());
    build_.box(door, {0, -0.015, 0}, {0.9, 0, 2.05}, kFront, leaf);
    build_.moulding(door, 0.9, 2.05, 0.08, 0.04, paint(0xfaf8f2), false);
    for (const double low : {0.2, 1.1}) {
      build_.moulding(on(kSouth, 0.75, low), 0.6, 0.75, 0.03, 0.03, wood(0xa27848, 0x8a6238, 0.45F, next_seed()), true);
    }
    build_.box(door, {0.78, -0.06, 1.0}, {0.86, -0.02, 1.03}, kHanging, paint(0xc9c5bd));
    framed_picture(kSouth, 2.1, 1.35, 0.5, 0.65, 0x5a4632);
    framed_picture(kSouth, 2.95, 1.2, 0.9, 0.9, 0x2b2622);
    framed_picture(kSouth, 4.2, 1.35, 0.5, 0.65, 0x5a4632);
    framed_picture(kSouth, 5.05, 1.35, 0.5, 0.65, 0x5a4632);
    const geometry::Pose cabinet = standing_at(-1.1, -kHalfWidth, 2.0 * kQuarterTurn);
    const Material body = wood(0xe6d2ad, 0xcdb283, 0.4F, next_seed());
    build_.box(cabinet, {-0.9, -0.42, 0.1}, {0.9, 0, 0.7}, kHanging, body);
    for (int i = 0; i < 3; ++i) {
      const double left = -0.88 + 0.59 * i;
      build_.box(cabinet, {left, -0.44, 0.13}, {left + 0.57, -0.42, 0.67}, kHanging, paint(0x6b8f71, 0.1F));
      build_.box(cabinet, {left + 0.26, -0.455, 0.56}, {left + 0.31, -0.44, 0.58}, kHanging, paint(0x2f2a26));
    }
    build_.box(standing_at(-1.6, -kHalfWidth + 0.22, 0.4), {-0.1, -0.1, 0.7}, {0.1, 0.1, 0.9}, kStanding,
               picture({0.2F, 0.2F}, 0.0F, next_seed()));
    build_.box(standing_at(-0.5, -kHalfWidth + 0.22, -0.2), {-0.17, -0.12, 0.7}, {0.17, 0.12, 0.86}, kStanding,
               paint(0xd98e5a, 0.15F));
  }

  /// The middle: a rug with a coffee table, both a little turned.
  void coffee_table() {
    const geometry::Pose at = standing_at(-0.9, -0.1, 0.0);
    build_.box(at, {-1.2, -0.8, 0}, {1.2, 0.8, 0.008}, kStanding, rug({2.4F, 1.6F}, next_seed()));
    const Material top = wood(0x8a5a36, 0x63391d, 0.12F, next_seed());
    build_.box(at, {-0.55, -0.3, 0.36}, {0.55, 0.3, 0.4}, kAllFaces, top);
    for (const double x : {-0.52, 0.46}) {
      for (const double y : {-0.27, 0.21}) {
        build_.box(at, {x, y, 0}, {x + 0.06, y + 0.06, 0.36}, kStanding, top);
      }
    }
    build_.box(standing_at(-1.1, -0.1, 0.3), {-0.13, -0.1, 0.4}, {0.13, 0.1, 0.43}, kStanding, paint(0xe76f51, 0.1F));
    build_.box(standing_at(-1.1, -0.1, 0.5), {-0.1, -0.08, 0.43}, {0.1, 0.08, 0.46}, kStanding, paint(0xf1e3c8, 0.1F));
    build_.box(standing_at(-0.6, 0.02, 0.1), {-0.06, -0.06, 0.4}, {0.06, 0.06, 0.52}, kStanding,
               Material{.texture = Texture::tiles, .colour = srgb(0xf2efe6), .accent = srgb(0x8c2f39), .scale = 0.04F});
  }

  /// Beams across, and two lamps between them.
  void ceiling() {
    const Material beam = wood(0xa27848, 0x7a5530, 0.2F, next_seed());
    for (const double x : {-1.9, 0.0, 1.9}) {
      build_.box(standing_at(x, 0, 0), {-0.07, -kHalfWidth, kHeight - 0.16}, {0.07, kHalfWidth, kHeight},
                 kLeft | kRight | kBottom, beam);
    }
    const Material glass = {.colour = srgb(0xfffaf0), .grain = 0.0F, .glow = 0.8F};
    for (const double x : {-0.95, 0.95}) {
      build_.box(standing_at(x, 0, 0), {-0.3, -0.3, kHeight - 0.05}, {0.3, 0.3, kHeight}, kAllFaces & ~kTop, glass);
      build_.lamp({{x, 0, kHeight - 0.06}, 0.3, 1.0F});
    }
  }

  base::Random random_;
  SceneBuilder build_;
};

}  // namespace

Scene make_room(std::uint64_t seed) { return Room(seed).make(); }

}  // namespace eg::synthetic
