// How fast the page of egraph-viewer shows a mesh of two million triangles in a browser without a graphics card: time
// to the first content, to everything, and frames per second while the view turns. Not a test: run it by hand.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include "services/viewer/mesh_tiles.hpp"
#include "services/viewer/web_server.hpp"
#include "tests/support/browser.hpp"

namespace {

using namespace eg;
using Clock = std::chrono::steady_clock;

constexpr int kTilesPerSide = 32;
constexpr int kCells = 32;  ///< per tile and axis, as the mapper's
constexpr double kTile = 0.64;

/// A tile of hilly ground: 2048 triangles.
mapping::MeshChunk ground(int tile_x, int tile_z) {
  mapping::MeshChunk chunk;
  chunk.tile = {tile_x, 0, tile_z};
  chunk.tile_size = kTile;
  for (int row = 0; row <= kCells; ++row) {
    for (int column = 0; column <= kCells; ++column) {
      const double x = kTile * (tile_x + column / double{kCells}), z = kTile * (tile_z + row / double{kCells});
      const double y = 0.2 * std::sin(3.0 * x) * std::cos(2.0 * z) + 0.02 * std::sin(40.0 * x) * std::sin(37.0 * z);
      chunk.mesh.vertices.emplace_back(Eigen::Vector3d(x, y, z).cast<float>());
      chunk.mesh.normals.emplace_back(-Eigen::Vector3f::UnitY());
      chunk.mesh.colours.push_back({static_cast<std::uint8_t>(128 + 100 * std::sin(x)), 150, 120});
    }
  }
  for (int row = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column) {
      const auto corner = static_cast<std::uint32_t>(row * (kCells + 1) + column);
      const std::uint32_t below = corner + kCells + 1;
      chunk.mesh.triangles.push_back({corner, corner + 1, below});
      chunk.mesh.triangles.push_back({corner + 1, below + 1, below});
    }
  }
  return chunk;
}

/// Turns the view for ten seconds and counts the frames of the second half, once the levels of detail have settled.
constexpr const char* kTurn = R"(new Promise((done) => {
  const {view} = egraph;
  const centre = view.controls.target.clone();
  const start = performance.now();
  let half = 0, counted = 0;
  const turn = () => {
    const time = performance.now() - start;
    view.camera.position.set(centre.x + 9 * Math.cos(time / 3000), centre.y + 4, centre.z + 9 * Math.sin(time / 3000));
    view.camera.lookAt(centre);
    view.moved();
    if (!half && time > 5000) { half = performance.now(); counted = view.stats.frames; }
    if (time < 10000) return requestAnimationFrame(turn);
    done({fps: 1000 * (view.stats.frames - counted) / (performance.now() - half), triangles: view.triangles});
  };
  turn();
}))";

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

int main() {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // figures are of use also when a later one takes too long
  services::Board board(500'000'000);
  services::KeyframeImages images(1);
  services::MeshTiles mesh(board);
  for (int x = 0; x < kTilesPerSide; ++x) {
    for (int z = 0; z < kTilesPerSide; ++z) mesh.add(ground(x, z));
  }
  auto page = services::load_page(EGRAPH_PAGE_DIR);
  if (!page) return std::fprintf(stderr, "%s\n", page.error().message.c_str()), 1;
  services::WebOptions options;
  options.address = "127.0.0.1:0";
  const auto server = services::WebServer::start(options, *page, board, images);
  if (!server) return std::fprintf(stderr, "%s\n", server.error().message.c_str()), 1;

  test::Browser browser;
  const auto start = Clock::now();
  const auto view = browser.open((*server)->url());
  view->resize(1280, 720);
  view->wait_for("egraph.summary().triangles > 0");
  std::printf("first content after %.2f s\n", seconds_since(start));
  view->wait_for("egraph.summary().tiles == " + std::to_string(kTilesPerSide * kTilesPerSide));
  std::printf("%s triangles after %.2f s, %.1f MB\n", view->evaluate("egraph.summary().triangles").c_str(),
              seconds_since(start), 1e-6 * static_cast<double>(board.bytes()));
  std::this_thread::sleep_for(std::chrono::seconds(5));  // levels of detail are made
  std::printf("turning: %s\n", view->evaluate(kTurn).c_str());
  std::this_thread::sleep_for(std::chrono::seconds(1));
  const std::string still =
      "(() => { const t = performance.now(); egraph.view.draw(); const gl = egraph.view.renderer.getContext();"
      " gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); return performance.now() - t; })()";
  std::printf("standing still: one frame of %s triangles in %s ms\n", view->evaluate("egraph.view.triangles").c_str(),
              view->evaluate(still).c_str());
  return 0;
}
