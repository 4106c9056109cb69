#include "tests/support/web_client.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <utility>

namespace eg::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;

constexpr std::chrono::seconds kPatience{20};
constexpr std::size_t kLargestMessage = 256U << 20U;

tcp::endpoint local(std::uint16_t port) { return {asio::ip::address_v4::loopback(), port}; }

std::string host_of(std::uint16_t port) { return "127.0.0.1:" + std::to_string(port); }

}  // namespace

std::uint16_t free_tcp_port() {
  asio::io_context context;
  return tcp::acceptor(context, local(0)).local_endpoint().port();
}

std::optional<HttpAnswer> http_get(std::uint16_t port, const std::string& target, const std::string& host) {
  return http_request(port, "GET", target, host);
}

std::optional<HttpAnswer> http_request(std::uint16_t port, const std::string& method, const std::string& target,
                                       const std::string& host) {
  RawConnection connection(port);
  const std::string& name = host.empty() ? host_of(port) : host;
  std::string request = method;
  request.append(" ").append(target).append(" HTTP/1.1\r\nHost: ").append(name);
  request.append("\r\nConnection: close\r\n\r\n");
  if (!connection.send(request)) return std::nullopt;
  // The answer's own length says where it ends: not every server closes the connection when asked to.
  beast::error_code failure;
  http::response_parser<http::string_body> parser;
  parser.body_limit(kLargestMessage);
  parser.eager(true);
  std::string unread;
  while (!parser.is_done()) {
    const std::string received = connection.receive(kPatience);
    if (received.empty()) return std::nullopt;
    unread += received;
    unread.erase(0, parser.put(asio::buffer(unread), failure));
    if (failure && failure != http::error::need_more) return std::nullopt;
  }
  const auto type = parser.get()[http::field::content_type];
  return HttpAnswer{static_cast<int>(parser.get().result_int()), std::string(type.data(), type.size()),
                    parser.get().body()};
}

RawConnection::RawConnection(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return;
  ::close(socket_);
  socket_ = -1;
}

RawConnection::~RawConnection() {
  if (socket_ >= 0) ::close(socket_);
}

RawConnection::RawConnection(RawConnection&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

bool RawConnection::send(const std::string& bytes) {
  return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
}

std::string RawConnection::receive(std::chrono::milliseconds limit) {
  pollfd ready{socket_, POLLIN, 0};
  if (limit.count() <= 0 || ::poll(&ready, 1, static_cast<int>(limit.count())) <= 0) return {};
  std::string bytes(65'536, '\0');
  const ssize_t got = ::recv(socket_, bytes.data(), bytes.size(), 0);
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
}

std::string RawConnection::receive_all(std::chrono::milliseconds limit) {
  using std::chrono::steady_clock;
  const auto end = steady_clock::now() + limit;
  std::string received;
  for (;;) {
    const std::string bytes = receive(std::chrono::duration_cast<std::chrono::milliseconds>(end - steady_clock::now()));
    if (bytes.empty()) return received;
    received += bytes;
  }
}

bool RawConnection::is_closed(std::chrono::milliseconds limit) {
  const auto start = std::chrono::steady_clock::now();
  receive_all(limit);
  return std::chrono::steady_clock::now() - start < limit;
}

class WebSocketClient::Implementation {
 public:
  asio::io_context context;
  websocket::stream<beast::tcp_stream> socket{context};
  beast::flat_buffer buffer;
};

WebSocketClient::WebSocketClient(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
WebSocketClient::~WebSocketClient() = default;

std::unique_ptr<WebSocketClient> WebSocketClient::connect(std::uint16_t port, const std::string& target,
                                                          const std::string& origin) {
  auto implementation = std::make_unique<Implementation>();
  auto& socket = implementation->socket;
  beast::error_code failure;
  beast::get_lowest_layer(socket).socket().connect(local(port), failure);
  if (failure) return nullptr;
  socket.read_message_max(kLargestMessage);
  socket.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
    if (!origin.empty()) request.set(http::field::origin, origin);
  }));
  socket.handshake(host_of(port), target, failure);
  if (failure) return nullptr;
  return std::unique_ptr<WebSocketClient>(new WebSocketClient(std::move(implementation)));
}

std::optional<std::string> WebSocketClient::read(std::chrono::milliseconds limit) {
  auto& [context, socket, buffer] = *implementation_;
  // A message may have come with the one before; else waiting for the first byte must not outlast the limit.
  beast::get_lowest_layer(socket).expires_after(limit);
  beast::error_code result = asio::error::would_block;
  socket.async_read(buffer, [&](beast::error_code failure, std::size_t) { result = failure; });
  context.restart();
  context.run();
  if (result) return std::nullopt;
  std::string message = beast::buffers_to_string(buffer.data());
  buffer.consume(buffer.size());
  return message;
}

bool WebSocketClient::write(const std::string& text) {
  beast::error_code failure;
  beast::get_lowest_layer(implementation_->socket).expires_after(kPatience);
  implementation_->socket.text(true);
  implementation_->socket.write(asio::buffer(text), failure);
  return !failure;
}

}  // namespace eg::test
