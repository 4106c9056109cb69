#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <functional>
#include <string>

#include "common/base/result.hpp"

namespace eg::services {

/// Takes browsers' connections at an address. When the process has no file descriptor left for one (or another error
/// keeps it from taking it), it says so once and tries again ten times a second: the connection waits in the kernel.
class Listener {
 public:
  using Handler = std::function<void(boost::asio::ip::tcp::socket)>;

  explicit Listener(boost::asio::io_context& context) : acceptor_(context), retry_(context) {}

  /// Binds to HOST:PORT (WebOptions::address). An error says what is wrong with it.
  base::Status open(const std::string& address);

  /// From now on `handler` gets every connection, in the context's thread.
  void accept(Handler handler);

  [[nodiscard]] bool is_loopback() const { return acceptor_.local_endpoint().address().is_loopback(); }
  /// "http://127.0.0.1:8080"
  [[nodiscard]] const std::string& url() const { return url_; }
  /// How often a connection could not be taken yet.
  [[nodiscard]] std::uint64_t postponed() const { return postponed_; }

 private:
  void accept_next();
  void try_again_later(const boost::system::error_code& failure);

  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer retry_;
  Handler handler_;
  std::string url_;
  bool complained_ = false;  ///< since the last connection that was taken
  std::atomic<std::uint64_t> postponed_ = 0;
};

}  // namespace eg::services
