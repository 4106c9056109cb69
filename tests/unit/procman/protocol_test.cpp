#include "common/procman/protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bot_procman/command2_t.hpp>
#include <bot_procman/deputy_cmd2_t.hpp>
#include <bot_procman/discovery_t.hpp>
#include <bot_procman/info2_t.hpp>
#include <bot_procman/orders2_t.hpp>
#include <bot_procman/printf_t.hpp>
#include <bot_procman/sheriff_cmd2_t.hpp>
#include <limits>

/// Against the classes that lcm-gen makes of the same types, which is what every other procman uses.
namespace eg::procman {
namespace {

using testing::HasSubstr;

template <typename Type>
std::uint64_t fingerprint() {
  return static_cast<std::uint64_t>(Type::getHash());
}

template <typename Type>
ProtocolBytes encode_reference(const Type& message) {
  ProtocolBytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return bytes;
}

TEST(Protocol, TypesHaveTheFingerprintsOfLibbot2) {
  EXPECT_EQ(fingerprint<bot_procman::command2_t>(), 0xf905d4ffa029810dU);
  EXPECT_EQ(fingerprint<bot_procman::sheriff_cmd2_t>(), 0x809fa6b3fc1ff2adU);
  EXPECT_EQ(fingerprint<bot_procman::orders2_t>(), 0xef1277a9fdb17943U);
  EXPECT_EQ(fingerprint<bot_procman::deputy_cmd2_t>(), 0x0f17aadccbe2f96eU);
  EXPECT_EQ(fingerprint<bot_procman::info2_t>(), 0xd0cf2ed34edd8314U);
  EXPECT_EQ(fingerprint<bot_procman::printf_t>(), 0x0abac44d8e3a7badU);
  EXPECT_EQ(fingerprint<bot_procman::discovery_t>(), 0x1116e1fff6333a71U);
}

bot_procman::command2_t reference_command() {
  bot_procman::command2_t command{};
  command.exec_str = "FOO=bar bash -c 'echo $FOO'";
  command.command_name = "ticker";
  command.group = "outer/inner";
  command.auto_respawn = 1;
  command.stop_signal = 15;
  command.stop_time_allowed = 2.5F;
  command.num_options = 2;
  command.option_names = {"a", "b"};
  command.option_values = {"1", ""};
  return command;
}

CommandDefinition same_command() {
  return {"FOO=bar bash -c 'echo $FOO'", "ticker", "outer/inner", true, 15, 2.5F, {{"a", "1"}, {"b", ""}}};
}

bot_procman::orders2_t reference_orders() {
  bot_procman::orders2_t orders{};
  orders.utime = 1'700'000'000'000'001;
  orders.host = "localhost";
  orders.sheriff_name = "robot:17:1700000000000000";
  orders.ncmds = 2;
  orders.cmds.resize(2);
  orders.cmds[0] = {reference_command(), 3, 0, 2'147'483'647};
  orders.cmds[1] = {reference_command(), -1, 1, 1};
  orders.num_options = 1;
  orders.option_names = {"name"};
  orders.option_values = {"value"};
  return orders;
}

Orders same_orders() {
  return {1'700'000'000'000'001,
          "localhost",
          "robot:17:1700000000000000",
          {{same_command(), 3, false, 2'147'483'647}, {same_command(), -1, true, 1}},
          {{"name", "value"}}};
}

TEST(Protocol, OrdersAreWhatLcmGenMakesOfThem) {
  const ProtocolBytes reference = encode_reference(reference_orders());
  EXPECT_EQ(encode(same_orders()), reference);
  const auto decoded = decode<Orders>(reference);
  ASSERT_TRUE(decoded.has_value()) << decoded.error().message;
  EXPECT_EQ(*decoded, same_orders());
}

TEST(Protocol, InfoIsWhatLcmGenMakesOfIt) {
  bot_procman::info2_t reference{};
  reference.utime = 5;
  reference.host = "robot";
  reference.cpu_load = 0.25F;
  reference.phys_mem_total_bytes = 1LL << 40;
  reference.phys_mem_free_bytes = 2;
  reference.swap_total_bytes = 3;
  reference.swap_free_bytes = 4;
  reference.ncmds = 1;
  reference.cmds.resize(1);
  reference.cmds[0] = {reference_command(), 17, 3, 768, 0.5F, 1LL << 33, 1LL << 32, 99};
  const Info info{5, "robot", 0.25F, 1LL << 40, 2, 3, 4, {{same_command(), 17, 3, 768, 0.5F, 1LL << 33, 1LL << 32, 99}},
                  {}};
  const ProtocolBytes bytes = encode_reference(reference);
  EXPECT_EQ(encode(info), bytes);
  const auto decoded = decode<Info>(bytes);
  ASSERT_TRUE(decoded.has_value()) << decoded.error().message;
  EXPECT_EQ(*decoded, info);
}

TEST(Protocol, PrintfAndDiscoveryAreWhatLcmGenMakesOfThem) {
  bot_procman::printf_t text{};
  text.utime = 1;
  text.deputy_name = "robot";
  text.sheriff_id = 7;
  text.text = "hello\n";
  EXPECT_EQ(encode(Printf{1, "robot", 7, "hello\n"}), encode_reference(text));
  EXPECT_EQ(*decode<Printf>(encode_reference(text)), (Printf{1, "robot", 7, "hello\n"}));

  bot_procman::discovery_t discovery{};
  discovery.utime = 2;
  discovery.nonce = -3;
  EXPECT_EQ(encode(Discovery{2, "", -3}), encode_reference(discovery));
  EXPECT_EQ(*decode<Discovery>(encode_reference(discovery)), (Discovery{2, "", -3}));
}

TEST(Protocol, EveryCutIsNoticed) {
  const ProtocolBytes bytes = encode(same_orders());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode<Orders>(std::span(bytes).first(size)).has_value()) << size;
  }
  ProtocolBytes longer = bytes;
  longer.push_back(0);
  EXPECT_THAT(decode<Orders>(longer).error().message, HasSubstr("1 bytes are left over"));
}

TEST(Protocol, ForeignTypesAndImpossibleValuesAreRefused) {
  EXPECT_THAT(decode<Info>(encode(same_orders())).error().message, HasSubstr("'fingerprint' is of another type"));
  const auto refused = [](auto change) {
    Orders orders = same_orders();
    change(orders.commands[0].definition);
    const auto decoded = decode<Orders>(encode(orders));
    return decoded ? std::string("accepted") : decoded.error().message;
  };
  EXPECT_THAT(refused([](auto& d) { d.stop_signal = -1; }), HasSubstr("'stop_signal' is no signal"));
  EXPECT_THAT(refused([](auto& d) { d.stop_signal = 65; }), HasSubstr("'stop_signal' is no signal"));
  for (const float time : {-1.0F, 1e30F, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_THAT(refused([&](auto& d) { d.stop_time_allowed = time; }), HasSubstr("'stop_time_allowed'")) << time;
  }
}

TEST(Protocol, AHugeCountAllocatesNothing) {
  ProtocolBytes bytes = encode(Orders{1, "h", "s", {}, {}});
  const std::size_t count = bytes.size() - 8;  // ncmds; behind it only num_options
  for (const std::uint8_t high : {0x7f, 0xff}) {
    bytes[count] = high;
    bytes[count + 1] = bytes[count + 2] = bytes[count + 3] = 0xff;
    EXPECT_FALSE(decode<Orders>(bytes).has_value());
  }
}

TEST(Protocol, ZeroMeansTheDefaultToADeputy) {
  const Command command = to_command({"x", "n", "g", false, 0, 0.0F, {}}, "robot");
  EXPECT_EQ(command.stop_signal, 2);
  EXPECT_EQ(command.stop_time_allowed, std::chrono::seconds(7));
  EXPECT_EQ(command.host, "robot");
  EXPECT_EQ(to_command({"x", "n", "g", false, 0, 0.25F, {}}, "").stop_time_allowed, std::chrono::milliseconds(250));
  EXPECT_EQ(to_definition(command), (CommandDefinition{"x", "n", "g", false, 2, 7.0F, {}}));
}

}  // namespace
}  // namespace eg::procman
