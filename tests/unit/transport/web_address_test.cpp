#include "common/transport/web_address.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace eg::transport {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// Somebody else's server on a port of its own.
class Server {
 public:
  Server() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(socket_, 1), 0);
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    address_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  }
  ~Server() { stop(); }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  void stop() {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }
  [[nodiscard]] const std::string& address() const { return address_; }

 private:
  int socket_;
  std::string address_;
};

TEST(WebAddress, HasHostAndPort) {
  const auto four = parse_web_address("127.0.0.1:8080");
  ASSERT_TRUE(four) << four.error().message;
  EXPECT_EQ(four->host, "127.0.0.1");
  EXPECT_EQ(four->port, 8080);
  const auto six = parse_web_address("[::1]:80");
  ASSERT_TRUE(six) << six.error().message;
  EXPECT_EQ(six->host, "::1");
  EXPECT_EQ(six->port, 80);
  for (const char* wrong : {"", ":", ":8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:80x", "[::1]"}) {
    EXPECT_THAT(parse_web_address(wrong).error().message, HasSubstr("is not an address like")) << wrong;
  }
}

TEST(WebAddress, IsFreeUntilSomebodyServesThere) {
  Server server;
  const auto taken = check_web_address(server.address());
  ASSERT_FALSE(taken);
  EXPECT_THAT(taken.error().message, HasSubstr(server.address() + ": Address already in use"));
  server.stop();
  EXPECT_TRUE(check_web_address(server.address()));
}

TEST(WebAddress, OfAnotherMachineOrByNameIsRefused) {
  EXPECT_THAT(check_web_address("192.0.2.1:8080").error().message, HasSubstr("192.0.2.1:8080"));
  EXPECT_THAT(check_web_address("robot:8080").error().message, HasSubstr("'robot' is no numeric address"));
}

TEST(WebAddress, IsFoundOnThisMachine) {
  const auto address = find_free_web_address();
  ASSERT_TRUE(address) << address.error().message;
  EXPECT_THAT(*address, StartsWith("127.0.0.1:8"));
  EXPECT_TRUE(check_web_address(*address));
}

}  // namespace
}  // namespace eg::transport
