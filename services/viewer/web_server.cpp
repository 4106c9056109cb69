#include "services/viewer/web_server.hpp"

#include <spdlog/spdlog.h>

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "services/viewer/listener.hpp"
#include "services/viewer/request_rules.hpp"

namespace eg::services {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using beast::error_code;

constexpr std::size_t kMaxRequestBytes = 8192;
constexpr std::size_t kMaxStreamMessage = 1024;  ///< browsers have nothing to say

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

class Stream;

/// What all connections share. Touched by the server's thread only, but for the counts.
struct Shared {
  WebOptions options;
  PageFiles page;
  const Board& board;
  const KeyframeImages& images;
  bool loopback = true;
  std::set<Stream*> streams{};
  std::atomic<int> connections = 0;
  std::atomic<int> browsers = 0;
  std::atomic<std::uint64_t> refused = 0;
};

/// Counts a connection as long as it is open.
class Ticket {
 public:
  explicit Ticket(Shared& shared) : shared_(&shared) { ++shared.connections; }
  Ticket(Ticket&& other) noexcept : shared_(std::exchange(other.shared_, nullptr)) {}
  Ticket& operator=(Ticket&&) = delete;
  ~Ticket() {
    if (shared_ != nullptr) --shared_->connections;
  }

 private:
  Shared* shared_;
};

/// One browser's stream of packets. It lives as long as an operation is pending.
class Stream : public std::enable_shared_from_this<Stream> {
 public:
  Stream(Shared& shared, Ticket ticket, beast::tcp_stream connection)
      : shared_(shared), ticket_(std::move(ticket)), socket_(std::move(connection)) {}
  ~Stream() {
    if (shared_.streams.erase(this) > 0) --shared_.browsers;
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  void start(const http::request<http::empty_body>& request) {
    beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has a clock of its own
    socket_.set_option(websocket::stream_base::timeout{shared_.options.patience, shared_.options.patience, true});
    socket_.read_message_max(kMaxStreamMessage);
    socket_.binary(true);
    socket_.async_accept(request, [self = shared_from_this()](error_code failure) {
      if (failure) return;
      self->shared_.streams.insert(self.get());
      ++self->shared_.browsers;
      self->read();
      self->send_next();
    });
  }

  /// Sends the next packet unless one is on its way. When there is none left, the next notification goes on.
  void send_next() {
    if (in_flight_ || failed_) return;
    const auto item = shared_.board.next(stamp_);
    if (!item) return;
    stamp_ = item->stamp;
    in_flight_ = item->bytes;
    socket_.async_write(asio::buffer(*in_flight_), [self = shared_from_this()](error_code failure, std::size_t) {
      self->in_flight_.reset();
      self->failed_ = self->failed_ || failure;
      self->send_next();
    });
  }

 private:
  /// Reading is what notices the end, and answers pings. What comes is thrown away.
  void read() {
    socket_.async_read(incoming_, [self = shared_from_this()](error_code failure, std::size_t) {
      self->incoming_.clear();
      if (!failure) return self->read();
      self->failed_ = true;
      beast::get_lowest_layer(self->socket_).close();
    });
  }

  Shared& shared_;
  Ticket ticket_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer incoming_;
  Board::Bytes in_flight_;
  std::uint64_t stamp_ = 0;
  bool failed_ = false;
};

/// One HTTP connection, until it ends or becomes a stream.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Shared& shared, tcp::socket socket)
      : shared_(shared), ticket_(shared), socket_(std::move(socket)), incoming_(kMaxRequestBytes) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxRequestBytes);
    socket_.expires_after(shared_.options.patience);
    http::async_read(socket_, incoming_, *parser_, [self = shared_from_this()](error_code failure, std::size_t) {
      if (failure == http::error::end_of_stream) return self->close();
      if (failure == beast::error::timeout || failure == asio::error::connection_reset) return;
      if (failure) return self->refuse(http::status::bad_request);
      self->handle(self->parser_->get());
    });
  }

 private:
  using Response = http::response<http::span_body<const char>>;

  void handle(const http::request<http::empty_body>& request) {
    const std::string_view host = view(request[http::field::host]);
    if (shared_.loopback && !names_this_machine(host)) return refuse(http::status::forbidden);
    const std::string_view path = path_of_target(view(request.target()));
    if (websocket::is_upgrade(request)) {
      if (path != "/stream") return refuse(http::status::not_found);
      if (!is_same_origin(view(request[http::field::origin]), host)) return refuse(http::status::forbidden);
      return std::make_shared<Stream>(shared_, std::move(ticket_), std::move(socket_))->start(request);
    }
    if (request.method() != http::verb::get) return refuse(http::status::method_not_allowed);
    if (const auto keyframe = keyframe_of_path(path)) {
      if (auto image = shared_.images.find(*keyframe)) {
        const char* bytes = reinterpret_cast<const char*>(image->bytes.data());
        return answer(http::status::ok, image->content_type, {bytes, image->bytes.size()}, image);
      }
    } else if (const auto file = shared_.page.find(path); file != shared_.page.end()) {
      return answer(http::status::ok, file->second.content_type, file->second.bytes, nullptr);
    }
    refuse(http::status::not_found);
  }

  void refuse(http::status status) {
    ++shared_.refused;
    const std::string_view reason = view(http::obsolete_reason(status));
    answer(status, "text/plain", reason, nullptr);
  }

  /// `owner` keeps `body` alive.
  void answer(http::status status, const std::string& content_type, std::string_view body,
              std::shared_ptr<const void> owner) {
    response_.emplace(status, 11);
    response_->set(http::field::content_type, content_type);
    response_->set(http::field::cache_control, "no-store");
    response_->set("X-Content-Type-Options", "nosniff");
    // The page loads nothing from anywhere else; what came over the bus cannot make it.
    response_->set("Content-Security-Policy",
                   "default-src 'self'; img-src 'self' blob: data:; connect-src 'self' ws:; frame-ancestors 'none'");
    response_->keep_alive(status == http::status::ok && parser_->get().keep_alive());
    response_->body() = beast::span<const char>(body.data(), body.size());
    response_->prepare_payload();
    body_owner_ = std::move(owner);
    socket_.expires_after(shared_.options.patience);
    http::async_write(socket_, *response_, [self = shared_from_this()](error_code failure, std::size_t) {
      if (failure) return;
      self->response_->keep_alive() ? self->read() : self->close();
    });
  }

  void close() {
    error_code ignored;
    socket_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  Shared& shared_;
  Ticket ticket_;
  beast::tcp_stream socket_;
  beast::flat_buffer incoming_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<Response> response_;
  std::shared_ptr<const void> body_owner_;
};

}  // namespace

class WebServer::Implementation {
 public:
  Implementation(const WebOptions& options, PageFiles page, const Board& board, const KeyframeImages& images)
      : shared_{options, std::move(page), board, images} {}
  ~Implementation() {
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  base::Status listen() {
    if (auto opened = listener_.open(shared_.options.address); !opened) return opened;
    shared_.loopback = listener_.is_loopback();
    return {};
  }

  void run() {
    listener_.accept([this](tcp::socket socket) { take(std::move(socket)); });
    thread_ = std::thread([this] {
      for (;;) {
        try {
          context_.run();
          return;
        } catch (const std::exception& exception) {
          spdlog::error("a browser's connection failed: {}", exception.what());
        }
      }
    });
  }

  void notify() {
    if (notified_.exchange(true)) return;
    asio::post(context_, [this] {
      notified_ = false;
      const std::set<Stream*> streams = shared_.streams;
      for (Stream* stream : streams) stream->send_next();
    });
  }

  [[nodiscard]] Counts counts() const {
    return {shared_.connections, shared_.browsers, shared_.refused, listener_.postponed()};
  }
  [[nodiscard]] const std::string& url() const { return listener_.url(); }

 private:
  void take(tcp::socket socket) {
    if (shared_.connections < shared_.options.max_connections) {
      std::make_shared<Connection>(shared_, std::move(socket))->read();
    } else {
      ++shared_.refused;  // too many; the socket closes
    }
  }

  Shared shared_;  // outlives the connections, which the context holds
  asio::io_context context_{1};
  Listener listener_{context_};
  std::atomic<bool> notified_ = false;
  std::thread thread_;
};

WebServer::WebServer(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
WebServer::~WebServer() = default;

base::Result<std::unique_ptr<WebServer>> WebServer::start(const WebOptions& options, PageFiles page, const Board& board,
                                                          const KeyframeImages& images) {
  auto implementation = std::make_unique<Implementation>(options, std::move(page), board, images);
  if (const auto listening = implementation->listen(); !listening) return tl::make_unexpected(listening.error());
  implementation->run();
  return std::unique_ptr<WebServer>(new WebServer(std::move(implementation)));
}

void WebServer::notify() { implementation_->notify(); }
WebServer::Counts WebServer::counts() const { return implementation_->counts(); }
const std::string& WebServer::url() const { return implementation_->url(); }

}  // namespace eg::services
