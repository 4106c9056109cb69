#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "common/base/result.hpp"
#include "common/transport/web_address.hpp"
#include "services/viewer/board.hpp"
#include "services/viewer/keyframe_images.hpp"
#include "services/viewer/page_files.hpp"

namespace eg::services {

struct WebOptions {
  std::string address = transport::kDefaultWebAddress;  ///< HOST:PORT, numeric ([::1]:8080 for IPv6); port 0: any
  int max_connections = 64;                             ///< at the same time; more are refused
  std::chrono::seconds patience{20};  ///< for a request, for an answer to be taken, for a silent browser
};

/// Serves the page, the keyframes' images (/keyframe/ID.jpg) and the stream of packets (WebSocket, /stream) from a
/// thread of its own. Read-only: what browsers send is not looked at.
///
/// A browser is sent one packet at a time, the next one when it has taken the last, so a slow one costs one packet of
/// memory. One that does not answer for `patience` is disconnected. Requests have a bounded size. Pages of other
/// origins cannot open the stream, and on a loopback address only requests that name this machine are answered, so that
/// no website that the user visits can look at the scene. A process without a file descriptor to spare lets browsers
/// wait until it has one.
class WebServer {
 public:
  /// What it has seen so far.
  struct Counts {
    int connections = 0;  ///< open now
    int browsers = 0;     ///< of them with a stream
    std::uint64_t refused = 0;
    std::uint64_t postponed = 0;  ///< attempts to take a connection while there was no file descriptor for it
  };

  /// Binds and starts. `board` and `images` must outlive the server. An error says what is wrong with the address.
  static base::Result<std::unique_ptr<WebServer>> start(const WebOptions& options, PageFiles page, const Board& board,
                                                        const KeyframeImages& images);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// There is something new on the board.
  void notify();

  [[nodiscard]] Counts counts() const;
  /// "http://127.0.0.1:8080"
  [[nodiscard]] const std::string& url() const;

 private:
  class Implementation;
  explicit WebServer(std::unique_ptr<Implementation> implementation);

  std::unique_ptr<Implementation> implementation_;
};

}  // namespace eg::services
