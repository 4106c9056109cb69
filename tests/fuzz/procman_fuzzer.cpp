// Everything that procman reads against arbitrary bytes: the first byte chooses message or file. The fingerprint is put
// right, else hardly an input would get past it. What is accepted must be encodable, and acceptable again.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/procman/exec_line.hpp"
#include "common/procman/protocol.hpp"

namespace {

using namespace eg::procman;

constexpr std::size_t kFingerprintBytes = 8;

template <typename Message>
void decode_one(std::span<const std::uint8_t> input) {
  ProtocolBytes bytes = encode(Message{});
  bytes.resize(kFingerprintBytes);
  bytes.insert(bytes.end(), input.begin(), input.end());
  const auto message = decode<Message>(bytes);
  // A string is taken up to its first zero when it is written.
  if (message && !decode<Message>(encode(*message))) std::abort();
}

void parse(std::string_view text) {
  const auto configuration = parse_configuration(text, "fuzz.pmd");
  if (!configuration) return;
  for (const Command& command : configuration->commands) {
    static_cast<void>(parse_exec(command.exec, [](const std::string&) { return std::nullopt; }));
  }
  for (const Script& script : configuration->scripts) static_cast<void>(check_script(*configuration, script.name));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> input(data + 1, size - 1);
  switch (data[0] % 5) {
    case 0:
      decode_one<Orders>(input);
      break;
    case 1:
      decode_one<Info>(input);
      break;
    case 2:
      decode_one<Printf>(input);
      break;
    case 3:
      decode_one<Discovery>(input);
      break;
    default:
      parse({reinterpret_cast<const char*>(input.data()), input.size()});
  }
  return 0;
}
