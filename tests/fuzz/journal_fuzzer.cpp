// The server's journal reader against arbitrary files: the fuzzer's bytes as they are, and as the bytes of sound
// records with the right fingerprints, so that what stands behind checksums is reached.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "common/io/journal.hpp"
#include "services/egraph_server/graph_replay.hpp"

namespace {

template <typename Message>
std::string message_of(std::string_view input) {
  static const eg::messages::Bytes kSample = eg::messages::encode(Message{});
  std::string message(kSample.begin(), kSample.begin() + 8);
  message.append(input);
  return message;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  if (eg::services::replay_journal(input, 1)) return 0;
  const std::string snapshot = message_of<eg::egraph::GraphSnapshot>(input.substr(0, size / 2));
  const std::string update = message_of<eg::egraph::GraphUpdate>(input.substr(size / 2));
  const eg::io::JournalRecord records[] = {{0, snapshot}, {1, update}};
  const std::string journal = eg::io::format_journal(eg::services::journal_schema(), records);
  const auto replayed = eg::services::replay_journal(journal, 1);
  if (replayed && !replayed->damage.empty()) std::abort();
  return 0;
}
