#include "services/viewer/listener.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "common/transport/web_address.hpp"

namespace eg::services {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::milliseconds kRetryPeriod{100};

}  // namespace

base::Status Listener::open(const std::string& text) {
  const auto address = transport::parse_web_address(text);
  if (!address) return tl::make_unexpected(address.error());
  error_code failure;
  const auto host = asio::ip::make_address(address->host, failure);
  if (failure) return base::fail("'" + address->host + "' is not a numeric address like 127.0.0.1");
  const tcp::endpoint endpoint(host, address->port);
  acceptor_.open(endpoint.protocol(), failure);
  if (!failure) acceptor_.set_option(asio::socket_base::reuse_address(true), failure);
  if (!failure) acceptor_.bind(endpoint, failure);
  if (!failure) acceptor_.listen(asio::socket_base::max_listen_connections, failure);
  if (failure) {
    return base::fail("cannot listen on " + text + ": " + failure.message() + "; choose another with --http");
  }
  const std::string name = address->host.find(':') == std::string::npos ? address->host : '[' + address->host + ']';
  url_ = "http://" + name + ':' + std::to_string(acceptor_.local_endpoint().port());
  return {};
}

void Listener::accept(Handler handler) {
  handler_ = std::move(handler);
  accept_next();
}

void Listener::accept_next() {
  acceptor_.async_accept([this](error_code failure, tcp::socket socket) {
    if (failure == asio::error::operation_aborted) return;
    if (failure) return try_again_later(failure);
    complained_ = false;
    handler_(std::move(socket));
    accept_next();
  });
}

void Listener::try_again_later(const error_code& failure) {
  ++postponed_;
  if (!std::exchange(complained_, true)) spdlog::warn("browsers have to wait: {}", failure.message());
  retry_.expires_after(kRetryPeriod);
  retry_.async_wait([this](error_code stopped) {
    if (!stopped) accept_next();
  });
}

}  // namespace eg::services
