#include "common/service/stop_signals.hpp"

#include <csignal>
#include <initializer_list>

namespace eg::service {
namespace {

volatile std::sig_atomic_t stop_flag = 0;

void request_stop(int /*signal*/) { stop_flag = 1; }

}  // namespace

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  action.sa_flags = SA_RESETHAND;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

bool stop_requested() { return stop_flag != 0; }

}  // namespace eg::service
