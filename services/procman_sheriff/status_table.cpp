#include "services/procman_sheriff/status_table.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstddef>

#include "common/base/printable.hpp"

namespace eg::procman_sheriff {
namespace {

using procman::CommandStatus;
using procman::ReportedCommand;

using Row = std::vector<std::string>;

constexpr double kMegabyte = 1e6;

std::string full_name(const procman::CommandDefinition& definition) {
  return base::printable(definition.group.empty() ? definition.name : definition.group + "/" + definition.name);
}

Row make_row(const std::string& name, const std::string& host, CommandStatus status, const ReportedCommand* report) {
  Row row = {name, base::printable(host), to_string(status), "", "", ""};
  if (report == nullptr || report->pid == 0) return row;
  row[3] = std::to_string(report->pid);
  row[4] = fmt::format("{:.0f} %", 100.0 * report->cpu_usage);
  row[5] = fmt::format("{:.0f} MB", static_cast<double>(report->resident_bytes) / kMegabyte);
  return row;
}

std::vector<std::string> align(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::vector<std::string> lines;
  for (const Row& row : rows) {
    std::string& line = lines.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) line += fmt::format("{:<{}}  ", row[i], widths[i]);
    line.erase(line.find_last_not_of(' ') + 1);
  }
  return lines;
}

}  // namespace

std::vector<std::string> make_status_table(const procman::Configuration& configuration, const procman::Sheriff& sheriff,
                                           procman::Now now) {
  std::vector<Row> rows = {{"COMMAND", "HOST", "STATUS", "PID", "CPU", "MEMORY"}};
  for (std::size_t i = 0; i < configuration.commands.size(); ++i) {
    const procman::Command& command = configuration.commands[i];
    rows.push_back(make_row(full_name(to_definition(command)), procman::Sheriff::host_of(command),
                            sheriff.status(i, now), sheriff.report(i)));
  }
  for (const auto& [host, deputy] : sheriff.deputies()) {
    for (const ReportedCommand& report : deputy.info.commands) {
      if (sheriff.find(report.sheriff_id) < configuration.commands.size()) continue;
      rows.push_back(make_row(full_name(report.definition), host, CommandStatus::removing, &report));
    }
  }
  std::vector<std::string> lines = align(rows);
  for (const auto& [host, deputy] : sheriff.deputies()) {
    const procman::Info& info = deputy.info;
    lines.push_back(fmt::format("deputy {}: {}, CPU {:.0f} %, {:.1f} of {:.1f} GB free", base::printable(host),
                                sheriff.is_stale(host, now) ? "silent" : "heard", 100.0 * info.cpu_load,
                                static_cast<double>(info.memory_free_bytes) / 1e9,
                                static_cast<double>(info.memory_total_bytes) / 1e9));
  }
  return lines;
}

}  // namespace eg::procman_sheriff
