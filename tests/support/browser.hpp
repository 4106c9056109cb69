#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/web_client.hpp"

namespace eg::test {

/// A page in a browser without a screen, driven over the DevTools protocol
/// (https://chromedevtools.github.io/devtools-protocol/).
class BrowserPage {
 public:
  BrowserPage(std::uint16_t port, const std::string& target);
  ~BrowserPage();

  /// The value of a JavaScript expression, as JSON text ("undefined" is null). Throws if the script does.
  std::string evaluate(const std::string& expression);
  /// Whether an expression becomes true within `limit`.
  bool wait_for(const std::string& expression, std::chrono::seconds limit = std::chrono::seconds(30));
  void reload();
  void resize(int width, int height);
  /// A click of the left button, pixels from the top left.
  void click(double x, double y);
  /// A PNG file of what is to be seen.
  void screenshot(const std::filesystem::path& file);

 private:
  std::string call(const std::string& method, const std::string& parameters);

  std::unique_ptr<WebSocketClient> socket_;
  int next_id_ = 1;
};

/// Chromium's headless shell, with WebGL in software.
class Browser {
 public:
  /// Whether it is installed (Debian: chromium-headless-shell).
  static bool is_installed();

  Browser();
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  std::unique_ptr<BrowserPage> open(const std::string& url);

 private:
  TemporaryFolder profile_;
  std::unique_ptr<Program> program_;
  std::uint16_t port_ = 0;
};

}  // namespace eg::test
