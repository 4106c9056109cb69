#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <vector>

#include "services/desktop_viewer/layer.hpp"

namespace eg::services {

/// A window of PCLVisualizer that shows layers. Keys: 1 to 9 switch them, t looks from above and back, q closes; the
/// mouse turns, shifts and zooms as in every PCLVisualizer. Needs an X display.
class Window {
 public:
  Window();
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Adds a layer or a part of one, or replaces the one of that name and part; the layer then stays on or off as it is.
  /// An empty shape removes it. Until the user has moved the view, it follows the scene's growth.
  void show(const Layer& layer);

  /// Draws and answers mouse and keys for about so long.
  void run_for(std::chrono::milliseconds time);
  [[nodiscard]] bool is_closed() const;

  /// Writes what is to be seen as a PNG file. False: it cannot be written.
  bool save_picture(const std::filesystem::path& file);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace eg::services
