#include "services/run/session.hpp"

#include <algorithm>
#include <utility>

#include "common/messages/service_name.hpp"

namespace eg::run {
namespace {

constexpr std::chrono::milliseconds kStep{20};
constexpr std::chrono::seconds kSaveLimit{120};
constexpr std::chrono::seconds kStopLimit{240};  ///< more than the stop times of all services together
constexpr std::int64_t kSaveRequestId = 1;
constexpr std::size_t kMostLinesShown = 20;  ///< warnings of services; all are in log.txt

constexpr std::string_view kSheriff = "[procman-sheriff] ";
/// What the viewer says when it is ready: "open URL in a browser".
constexpr std::string_view kPageIsThere = "[viewer] open http";
constexpr std::string_view kError = "error: ";
constexpr std::string_view kWarning = "warning: ";
/// Services that are killed come back. So many deaths of one without a frame being finished in between are no accident.
constexpr int kMostDeathsInARow = 10;

bool calls_for_attention(std::string_view line) {
  const std::size_t end_of_name = line.find("] ");
  if (!line.starts_with('[') || end_of_name == std::string_view::npos) return false;
  const std::string_view text = line.substr(end_of_name + 2);
  return text.starts_with(kWarning) || text.starts_with(kError);
}

RunMonitor::Options monitor_options(const RunOptions& options) {
  RunMonitor::Options monitor;
  monitor.lockstep = !options.realtime;
  monitor.consumers = {"tracker"};
  if (options.mapper) monitor.consumers.emplace_back("mapper");
  return monitor;
}

service::ServiceOptions context_options() {
  service::ServiceOptions options;
  options.name = "run";
  return options;
}

}  // namespace

Session::Session(const RunOptions& options, const Input& input, transport::Bus& bus, SheriffProcess& sheriff,
                 StopCount stops)
    : sheriff_(sheriff),
      bus_(bus),
      stops_(std::move(stops)),
      context_(bus, context_options()),
      monitor_(context_, monitor_options(options), Clock::now()),
      save_request_(context_, kSaveRequestId),
      progress_(input.frames, Clock::now()),
      savers_{"frame_source", "egraph_server", "tracker"},
      keep_view_(options.keep_view) {
  if (options.mapper) savers_.insert("mapper");
}

void Session::run() {
  process_frames();
  frames_running_ = false;
  if (!interrupted()) save();
  if (keep_view_ && !view_url_.empty() && failure_.empty() && !interrupted()) keep_view();
  stop();
}

double Session::processing_seconds() const { return std::chrono::duration<double>(last_frame_ - first_frame_).count(); }

void Session::process_frames() {
  std::int64_t done = 0;
  while (failure_.empty() && !interrupted() && !monitor_.finished()) {
    step();
    const Clock::time_point now = Clock::now();
    if (monitor_.frames_done() > done) {
      if (done == 0) first_frame_ = now;
      last_frame_ = now;
      done = monitor_.frames_done();
    }
    if (const auto why = monitor_.stalled()) fail(*why);
    progress_.show(monitor_, now);
  }
  progress_.finish(monitor_, Clock::now());
  if (failure_.empty() && !interrupted() && done == 0) fail("no frame of the input could be processed");
}

void Session::save() {
  if (!sheriff_.running()) return;
  const Clock::time_point end = Clock::now() + kSaveLimit;
  save_request_.start(savers(), Clock::now());
  while (!save_request_.done() && !interrupted() && sheriff_.running() && Clock::now() < end) {
    step();
    save_request_.update(Clock::now());
  }
  for (const std::string& service : save_request_.waiting_for()) {
    if (!interrupted()) fail("service " + service + " has not answered the request to save its results");
  }
  for (const auto& [service, why] : save_request_.failures()) fail("service " + service + " could not save: " + why);
}

void Session::keep_view() {
  const Clock::time_point begin = Clock::now();
  progress_.print("The results are saved. The page stays at " + view_url_ + " until Ctrl-C.");
  while (stops_() == 0 && failure_.empty() && sheriff_.running()) step();
  expected_stops_ = stops_();
  viewing_ = Clock::now() - begin;
}

void Session::stop() {
  const Clock::time_point end = Clock::now() + kStopLimit;
  const int stops_before = stops_();
  sheriff_.interrupt();
  bool hurried = false;
  while (sheriff_.running() && Clock::now() < end) {
    step();
    if (!hurried && stops_() > std::max(stops_before, 1)) {
      sheriff_.interrupt();
      hurried = true;
    }
  }
  if (sheriff_.running()) {
    fail("the services could not be stopped and were killed");
    sheriff_.kill();
    while (sheriff_.running()) step();
  }
  sheriff_.read_output([this](const std::string& line) { handle_line(line); });
}

void Session::step() {
  if (const auto handled = bus_.handle(kStep); !handled && stops_() == 0) fail(handled.error().message);
  monitor_.update(Clock::now());
  const bool running = sheriff_.running();
  sheriff_.read_output([this](const std::string& line) { handle_line(line); });
  if (frames_running_ && !running) fail("procman-sheriff has ended unexpectedly");
}

void Session::handle_line(const std::string& line) {
  if (calls_for_attention(line) && warnings_.size() < kMostLinesShown && warnings_.insert(line).second) {
    progress_.print(warnings_.size() < kMostLinesShown ? line : "more warnings are in log.txt");
  }
  if (line.starts_with(kPageIsThere)) show_page_address(line);
  if (!line.starts_with(kSheriff)) return note_error(line);
  std::string_view text = std::string_view(line).substr(kSheriff.size());
  const bool error = text.starts_with(kError);
  const bool comes_back = text.starts_with(kWarning);  // procman starts it again
  if (error) text.remove_prefix(kError.size());
  if (comes_back) text.remove_prefix(kWarning.size());
  const std::string name(text.substr(0, text.find(' ')));
  const std::string_view what = text.substr(name.size());
  const bool ended = what.starts_with(" ended with ") || what.starts_with(" could not be started");
  if (comes_back && ended && !has_given_up(name, what)) return;
  if (ended) {
    ended_.insert(name);
    save_request_.give_up_on(name);
  }
  // While frames are being processed no service may end for good, not even without an error.
  if (!error && !(frames_running_ && ended)) return;
  const auto reason = last_errors_.find(name);
  fail((ended ? "service " : "") + std::string(text) + (reason == last_errors_.end() ? "" : ": " + reason->second));
}

void Session::note_error(const std::string& line) {
  const std::size_t end_of_name = line.find("] ");
  if (!line.starts_with('[') || end_of_name == std::string::npos) return;
  const std::string_view text = std::string_view(line).substr(end_of_name + 2);
  if (text.starts_with(kError)) last_errors_[line.substr(1, end_of_name - 1)] = text.substr(kError.size());
}

void Session::show_page_address(std::string_view line) {
  if (!view_url_.empty()) return;  // it has been killed and is back at the same address
  const std::string_view url = line.substr(line.find("http"));
  view_url_ = url.substr(0, url.find(' '));
  progress_.print("Watch it: open " + view_url_ + " in a browser");
}

std::set<std::string> Session::savers() const {
  std::set<std::string> names;
  for (const std::string& service : savers_) names.merge(monitor_.names_of(service));
  for (const std::string& name : ended_) names.erase(name);
  return names;
}

bool Session::has_given_up(const std::string& name, std::string_view how) {
  const bool is_needed =
      name == "feature_extractor" ||
      std::any_of(savers_.begin(), savers_.end(), [&](const auto& of) { return messages::is_of_service(name, of); });
  if (!is_needed) return false;
  if (monitor_.frames_done() > done_at_last_death_) deaths_.clear();
  done_at_last_death_ = monitor_.frames_done();
  // What ends by itself has said why, and would say it again.
  return how.find("exit status") != std::string_view::npos || ++deaths_[name] >= kMostDeathsInARow;
}

void Session::fail(const std::string& why) {
  // The first reason is the reason; what follows are consequences.
  if (failure_.empty()) failure_ = why;
}

}  // namespace eg::run
