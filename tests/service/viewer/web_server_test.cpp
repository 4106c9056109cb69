#include "services/viewer/web_server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "services/viewer/request_rules.hpp"
#include "tests/support/web_client.hpp"

namespace eg::services {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr int kMaxConnections = 20;

/// Memory of this process, bytes.
std::size_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::size_t total = 0, resident = 0;
  file >> total >> resident;
  return resident * 4096;
}

class WebServerTest : public testing::Test {
 protected:
  WebServerTest() {
    WebOptions options;
    options.address = "127.0.0.1:0";
    options.max_connections = kMaxConnections;
    options.patience = 2s;
    PageFiles page = {{"/", {"text/html", "<p>page</p>"}}, {"/main.js", {"text/javascript", "let a;"}}};
    server_ = std::move(*WebServer::start(options, std::move(page), board_, images_));
    port_ = static_cast<std::uint16_t>(std::stoi(server_->url().substr(server_->url().rfind(':') + 1)));
  }

  int status(const std::string& target) const {
    const auto answer = test::http_get(port_, target);
    return answer ? answer->status : 0;
  }

  bool works() const { return status("/main.js") == 200; }

  Board board_{200'000'000};
  KeyframeImages images_{1000};
  std::unique_ptr<WebServer> server_;
  std::uint16_t port_ = 0;
};

TEST_F(WebServerTest, ServesThePageAndTheImagesOfKeyframes) {
  images_.put(3, {"image/jpeg", {'j', 'p', 'g'}});
  const auto page = test::http_get(port_, "/?a=b");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_EQ(page->content_type, "text/html");
  EXPECT_EQ(page->body, "<p>page</p>");
  const auto image = test::http_get(port_, "/keyframe/3.jpg");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->body, "jpg");
  EXPECT_EQ(image->content_type, "image/jpeg");
  EXPECT_EQ(status("/keyframe/4.jpg"), 404);
}

TEST_F(WebServerTest, HasNothingButItsTable) {
  for (const char* target :
       {"/../../etc/passwd", "//etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/..", "/main.js/..", "/keyframe/../main.js",
        "/keyframe/.jpg", "/keyframe/99999999999999.jpg", "/keyframe/-1.jpg", "http://elsewhere/etc/passwd"}) {
    EXPECT_EQ(status(target), 404) << target;
  }
  EXPECT_EQ(test::http_request(port_, "POST", "/")->status, 405);
  EXPECT_EQ(test::http_request(port_, "DELETE", "/main.js")->status, 405);
  EXPECT_TRUE(works());
}

TEST_F(WebServerTest, AnswersOnlyThoseWhoAskForThisMachine) {
  EXPECT_EQ(test::http_get(port_, "/", "attacker.example:8080")->status, 403);
  EXPECT_EQ(test::http_get(port_, "/", "127.0.0.1.attacker.example")->status, 403);
  EXPECT_EQ(test::http_get(port_, "/", "localhost:1234")->status, 200);
}

TEST_F(WebServerTest, OpensTheStreamToItsOwnPagesOnly) {
  const std::string own = "http://127.0.0.1:" + std::to_string(port_);
  EXPECT_NE(test::WebSocketClient::connect(port_, "/stream", own), nullptr);
  EXPECT_NE(test::WebSocketClient::connect(port_, "/stream"), nullptr);  // no browser
  EXPECT_EQ(test::WebSocketClient::connect(port_, "/stream", "http://attacker.example"), nullptr);
  EXPECT_EQ(test::WebSocketClient::connect(port_, "/elsewhere", own), nullptr);
}

TEST_F(WebServerTest, StreamsWhatIsThereAndThenWhatChanges) {
  board_.put("a", {1});
  board_.put("b", {2});
  const auto stream = test::WebSocketClient::connect(port_, "/stream");
  ASSERT_NE(stream, nullptr);
  EXPECT_EQ(stream->read(5s), "\1");
  EXPECT_EQ(stream->read(5s), "\2");
  board_.put("a", {3});
  server_->notify();
  EXPECT_EQ(stream->read(5s), "\3");
}

TEST_F(WebServerTest, RefusesMalformedAndHugeRequests) {
  const std::string garbage(300, '\x80');
  for (const std::string& request :
       {std::string("HELLO\r\n\r\n"), garbage, "GET /" + std::string(100'000, 'a') + " HTTP/1.1\r\n\r\n",
        "GET / HTTP/1.1\r\nX: " + std::string(1'000'000, 'b') + "\r\n\r\n",
        std::string("GET /stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: upgrade\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999\r\n\r\n")}) {
    test::RawConnection connection(port_);
    ASSERT_TRUE(connection.open());
    connection.send(request);
    EXPECT_TRUE(connection.is_closed(5s)) << request.substr(0, 60);
    EXPECT_TRUE(works());
  }
  EXPECT_GT(server_->counts().refused, 0u);
}

TEST_F(WebServerTest, DisconnectsAStreamThatSendsTooMuch) {
  const auto stream = test::WebSocketClient::connect(port_, "/stream");
  ASSERT_NE(stream, nullptr);
  EXPECT_TRUE(stream->write("hello"));
  stream->write(std::string(100'000, 'x'));
  EXPECT_EQ(stream->read(5s), std::nullopt);
  EXPECT_TRUE(works());
}

TEST_F(WebServerTest, DisconnectsWhoNeverFinishesARequest) {
  test::RawConnection connection(port_);
  connection.send("GET / HTTP/1.1\r\nHost: ");
  EXPECT_TRUE(connection.is_closed(8s));
}

TEST_F(WebServerTest, RefusesMoreConnectionsThanItTakesAndRecovers) {
  {
    std::vector<test::RawConnection> connections;
    for (int i = 0; i < 100; ++i) connections.emplace_back(port_);
    for (int i = 0; i < 100 && server_->counts().refused < 80; ++i) std::this_thread::sleep_for(20ms);
    EXPECT_EQ(server_->counts().connections, kMaxConnections);
    EXPECT_EQ(server_->counts().refused, 80u);
  }
  for (int i = 0; i < 100 && server_->counts().connections > 0; ++i) std::this_thread::sleep_for(50ms);
  EXPECT_EQ(server_->counts().connections, 0);
  EXPECT_TRUE(works());
}

/// This process may open no more files as long as it exists.
class NoMoreFiles {
 public:
  NoMoreFiles() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const int lowest_free = open("/dev/null", O_RDONLY | O_CLOEXEC);
    close(lowest_free);
    rlimit none = before_;
    none.rlim_cur = static_cast<rlim_t>(lowest_free);
    setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoMoreFiles() { setrlimit(RLIMIT_NOFILE, &before_); }
  NoMoreFiles(const NoMoreFiles&) = delete;
  NoMoreFiles& operator=(const NoMoreFiles&) = delete;

 private:
  rlimit before_{};
};

TEST_F(WebServerTest, BrowsersWaitWhileThereIsNoFileDescriptor) {
  const int browser = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port_);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto begin = std::chrono::steady_clock::now();
  {
    const NoMoreFiles none;
    ASSERT_EQ(connect(browser, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    for (int i = 0; i < 500 && server_->counts().postponed < 3; ++i) std::this_thread::sleep_for(10ms);
  }
  EXPECT_TRUE(works());
  const auto periods = static_cast<std::uint64_t>((std::chrono::steady_clock::now() - begin) / 100ms);
  EXPECT_GE(server_->counts().postponed, 3u);
  EXPECT_LE(server_->counts().postponed, periods + 1) << "it asks again and again without a pause";
  EXPECT_EQ(server_->counts().refused, 0u);
  close(browser);
}

// 5000 packets of 64 kB pass by while it sleeps; it costs one packet and what the kernel buffers, and is let go.
TEST_F(WebServerTest, AStreamThatIsNeverReadCostsNoMemoryAndEnds) {
  const auto stream = test::WebSocketClient::connect(port_, "/stream");
  ASSERT_NE(stream, nullptr);
  for (int i = 0; i < 100 && server_->counts().browsers == 0; ++i) std::this_thread::sleep_for(10ms);
  const std::size_t before = resident_bytes();
  for (int i = 0; i < 5000; ++i) {
    std::vector<std::uint8_t> packet(65'536, static_cast<std::uint8_t>(i));
    packet[0] = static_cast<std::uint8_t>(i / 256);
    board_.put("live", std::move(packet));
    server_->notify();
  }
  EXPECT_LT(resident_bytes(), before + 40'000'000);
  for (int i = 0; i < 200 && server_->counts().browsers > 0; ++i) std::this_thread::sleep_for(50ms);
  EXPECT_EQ(server_->counts().browsers, 0);
  EXPECT_TRUE(works());
}

TEST(WebServer, SaysWhatIsWrongWithTheAddress) {
  const Board board(1000);
  const KeyframeImages images(1000);
  const auto complaint = [&](const std::string& address) {
    WebOptions options;
    options.address = address;
    const auto server = WebServer::start(options, {}, board, images);
    return server ? std::string("none") : server.error().message;
  };
  EXPECT_THAT(complaint("8080"), HasSubstr("not an address like"));
  EXPECT_THAT(complaint("127.0.0.1:99999"), HasSubstr("not an address like"));
  EXPECT_THAT(complaint("robot:8080"), HasSubstr("not a numeric address"));
  EXPECT_THAT(complaint("203.0.113.1:8080"), HasSubstr("cannot listen on 203.0.113.1:8080"));
  EXPECT_EQ(complaint("[::1]:0"), "none");
}

}  // namespace
}  // namespace eg::services
