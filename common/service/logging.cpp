#include "common/service/logging.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <string_view>

namespace eg::service {
namespace {

/// Names the level only when it calls for attention.
class AttentionFlag : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm& /*time*/, spdlog::memory_buf_t& line) override {
    const std::string_view word = message.level >= spdlog::level::err    ? "error: "
                                  : message.level >= spdlog::level::warn ? "warning: "
                                                                         : "";
    line.append(word.data(), word.data() + word.size());
  }

  [[nodiscard]] std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<AttentionFlag>();
  }
};

}  // namespace

void log_to_stderr(const std::string& name) {
  auto logger = spdlog::get(name);
  if (!logger) logger = spdlog::stderr_logger_mt(name);
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<AttentionFlag>('*').set_pattern("[%n] %*%v");
  logger->set_formatter(std::move(formatter));
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace eg::service
