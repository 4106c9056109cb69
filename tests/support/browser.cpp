#include "tests/support/browser.hpp"

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

namespace eg::test {
namespace {

using Json = nlohmann::json;

// Not the script of the same name in /usr/bin, which would stand between it and our signals.
constexpr const char* kProgram = "/usr/lib/chromium/chromium-headless-shell";
constexpr std::chrono::seconds kAnswerLimit{60};
constexpr std::chrono::milliseconds kPoll{50};

std::string decode_base64(const std::string& text) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t value = alphabet.find(c);
    if (value == std::string::npos) break;  // padding
    bits = (bits << 6U) | static_cast<std::uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>((bits >> static_cast<unsigned>(count)) & 0xFFU);
  }
  return bytes;
}

}  // namespace

BrowserPage::BrowserPage(std::uint16_t port, const std::string& target)
    : socket_(WebSocketClient::connect(port, target)) {
  if (!socket_) throw std::runtime_error("the browser does not answer");
}

BrowserPage::~BrowserPage() = default;

std::string BrowserPage::call(const std::string& method, const std::string& parameters) {
  const int id = next_id_++;
  const Json request = {{"id", id}, {"method", method}, {"params", Json::parse(parameters)}};
  if (!socket_->write(request.dump())) throw std::runtime_error("the browser has gone");
  for (;;) {
    const auto message = socket_->read(kAnswerLimit);
    if (!message) throw std::runtime_error("no answer from the browser to " + method);
    const Json answer = Json::parse(*message);
    if (answer.value("id", 0) != id) continue;  // an event
    if (answer.contains("error")) throw std::runtime_error(answer["error"].dump());
    return answer["result"].dump();
  }
}

std::string BrowserPage::evaluate(const std::string& expression) {
  const Json parameters = {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}};
  const Json result = Json::parse(call("Runtime.evaluate", parameters.dump()));
  if (result.contains("exceptionDetails")) throw std::runtime_error(result["exceptionDetails"].dump());
  return result["result"].value("value", Json()).dump();
}

bool BrowserPage::wait_for(const std::string& expression, std::chrono::seconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  const std::string guarded = "(() => { try { return Boolean(" + expression + "); } catch { return false; } })()";
  while (std::chrono::steady_clock::now() < end) {
    if (evaluate(guarded) == "true") return true;
    std::this_thread::sleep_for(kPoll);
  }
  return false;
}

void BrowserPage::reload() { call("Page.reload", "{}"); }

void BrowserPage::resize(int width, int height) {
  const Json metrics = {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", width < 600}};
  call("Emulation.setDeviceMetricsOverride", metrics.dump());
}

void BrowserPage::click(double x, double y) {
  for (const char* type : {"mousePressed", "mouseReleased"}) {
    const Json event = {{"type", type}, {"x", x}, {"y", y}, {"button", "left"}, {"clickCount", 1}};
    call("Input.dispatchMouseEvent", event.dump());
  }
}

void BrowserPage::screenshot(const std::filesystem::path& file) {
  const Json result = Json::parse(call("Page.captureScreenshot", R"({"format": "png"})"));
  std::ofstream(file, std::ios::binary) << decode_base64(result["data"]);
}

bool Browser::is_installed() { return std::filesystem::exists(kProgram); }

Browser::Browser() {
  // Root needs --no-sandbox; what is shown here comes from this machine only.
  program_ = std::make_unique<Program>(
      kProgram, std::vector<std::string>{"--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                                         "--remote-debugging-port=0", "--disable-background-networking",
                                         "--user-data-dir=" + profile_.path().string(), "about:blank"});
  const std::string announcement = "DevTools listening on ws://127.0.0.1:";
  if (!program_->wait_for_output("/devtools/browser/")) throw std::runtime_error(program_->output());
  const std::string output = program_->output();
  port_ = static_cast<std::uint16_t>(std::stoi(output.substr(output.find(announcement) + announcement.size())));
}

Browser::~Browser() {
  program_->send_signal(SIGTERM);  // it ends its own processes
  program_->wait(std::chrono::seconds(10));
}

std::unique_ptr<BrowserPage> Browser::open(const std::string& url) {
  const auto answer = http_request(port_, "PUT", "/json/new?" + url);
  if (!answer) throw std::runtime_error("the browser opens no page");
  const std::string address = Json::parse(answer->body)["webSocketDebuggerUrl"];
  return std::make_unique<BrowserPage>(port_, address.substr(address.find("/devtools")));
}

}  // namespace eg::test
