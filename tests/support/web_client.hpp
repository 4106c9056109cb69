#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// Simple clients for servers on this machine; blocking, with limits. What fails is "nothing".
namespace eg::test {

/// A TCP port of 127.0.0.1 that nobody used a moment ago.
std::uint16_t free_tcp_port();

struct HttpAnswer {
  int status = 0;
  std::string content_type;
  std::string body;
};

/// GET of a target on 127.0.0.1. `host` is the Host header; empty: the address itself.
std::optional<HttpAnswer> http_get(std::uint16_t port, const std::string& target, const std::string& host = {});

/// The same with another method.
std::optional<HttpAnswer> http_request(std::uint16_t port, const std::string& method, const std::string& target,
                                       const std::string& host = {});

/// A bare TCP connection to 127.0.0.1, for saying what no client would say.
class RawConnection {
 public:
  explicit RawConnection(std::uint16_t port);
  ~RawConnection();
  RawConnection(RawConnection&& other) noexcept;
  RawConnection& operator=(RawConnection&&) = delete;

  [[nodiscard]] bool open() const { return socket_ >= 0; }
  bool send(const std::string& bytes);
  /// What comes next; empty: nothing within `limit`, or the other side has closed.
  std::string receive(std::chrono::milliseconds limit);
  /// What comes until the other side closes or `limit` is over.
  std::string receive_all(std::chrono::milliseconds limit = std::chrono::seconds(5));
  /// Whether the other side closes within `limit`.
  bool is_closed(std::chrono::milliseconds limit);

 private:
  int socket_ = -1;
};

class WebSocketClient {
 public:
  /// Null: the server refuses. `origin`: as a page of that origin.
  static std::unique_ptr<WebSocketClient> connect(std::uint16_t port, const std::string& target,
                                                  const std::string& origin = {});
  ~WebSocketClient();
  WebSocketClient(const WebSocketClient&) = delete;
  WebSocketClient& operator=(const WebSocketClient&) = delete;

  /// The next message. Nothing: none came within `limit`, or the connection had ended; it is of no more use then.
  std::optional<std::string> read(std::chrono::milliseconds limit);
  bool write(const std::string& text);

 private:
  class Implementation;
  explicit WebSocketClient(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace eg::test
