#include "common/transport/event_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>

#include <fstream>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/transport/recorder.hpp"

namespace eg::transport {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class EventLog : public testing::Test {
 protected:
  void write_three() {
    auto writer = EventLogWriter::create(path_);
    ASSERT_TRUE(writer) << writer.error().message;
    ASSERT_TRUE(writer->write("EG1_A", bytes_of("one"), 1'000'000));
    ASSERT_TRUE(writer->write("EG2_A", bytes_of(""), 2'000'000));
    ASSERT_TRUE(writer->write("EG1_B", bytes_of("three"), 3'000'000));
    ASSERT_TRUE(writer->flush());
  }

  /// Everything that can be read; `error` says why it ended, if not at the end of the file.
  std::vector<std::string> read_all(std::string* error) const {
    std::vector<std::string> texts;
    auto reader = EventLogReader::open(path_);
    EXPECT_TRUE(reader) << reader.error().message;
    for (;;) {
      const auto event = reader->next();
      if (!event) *error = event.error().message;
      if (!event || !*event) return texts;
      texts.emplace_back((*event)->bytes.begin(), (*event)->bytes.end());
    }
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "run.lcm";
};

TEST_F(EventLog, GivesBackWhatWasWritten) {
  write_three();
  std::string error;
  EXPECT_THAT(read_all(&error), ElementsAre("one", "", "three"));
  EXPECT_EQ(error, "");
}

TEST_F(EventLog, LcmReadsWhatWeWrite) {
  write_three();
  lcm_eventlog_t* log = lcm_eventlog_create(path_.c_str(), "r");
  ASSERT_NE(log, nullptr);
  std::vector<std::string> lines;
  while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log)) {
    lines.push_back(std::string(event->channel) + " " + std::to_string(event->timestamp) + " " +
                    std::string(static_cast<const char*>(event->data), static_cast<std::size_t>(event->datalen)));
    lcm_eventlog_free_event(event);
  }
  lcm_eventlog_destroy(log);
  EXPECT_THAT(lines, ElementsAre("EG1_A 1000000 one", "EG2_A 2000000 ", "EG1_B 3000000 three"));
}

TEST_F(EventLog, WeReadWhatLcmWrites) {
  lcm_eventlog_t* log = lcm_eventlog_create(path_.c_str(), "w");
  ASSERT_NE(log, nullptr);
  char channel[] = "CHANNEL";
  char data[] = "data";
  lcm_eventlog_event_t event{0, 77, 7, 4, channel, data};
  ASSERT_EQ(lcm_eventlog_write_event(log, &event), 0);
  lcm_eventlog_destroy(log);
  auto reader = EventLogReader::open(path_);
  ASSERT_TRUE(reader);
  const auto read = reader->next();
  ASSERT_TRUE(read && *read);
  EXPECT_EQ((*read)->channel, "CHANNEL");
  EXPECT_EQ((*read)->utime, 77);
  EXPECT_EQ(std::string((*read)->bytes.begin(), (*read)->bytes.end()), "data");
}

TEST_F(EventLog, SaysWhereAFileEndsTooSoon) {
  write_three();
  const auto size = std::filesystem::file_size(path_);
  for (std::uintmax_t cut = size - 1; cut > size - 30; --cut) {
    std::filesystem::resize_file(path_, cut);
    std::string error;
    EXPECT_THAT(read_all(&error), ElementsAre("one", ""));
    EXPECT_THAT(error, HasSubstr("ends within an event (byte 69)"));
  }
}

TEST_F(EventLog, GoesOnBehindDamageAndCountsWhatItPassedOver) {
  write_three();
  std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(36);  // the second event's sync word
  file.write("lost", 4);
  file.close();
  auto reader = EventLogReader::open(path_);
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->next().value()->offset, 0U);
  const auto damaged = reader->next();
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().message, HasSubstr("run.lcm has no event (byte 36)"));
  EXPECT_EQ(reader->recover(), 33U);
  const auto third = reader->next();
  ASSERT_TRUE(third && *third) << third.error().message;
  EXPECT_EQ((*third)->channel, "EG1_B");
  EXPECT_EQ((*third)->offset, 69U);
  EXPECT_EQ(reader->next().value(), std::nullopt);
  reader->seek(69);
  EXPECT_EQ(reader->next().value()->channel, "EG1_B");
}

TEST_F(EventLog, DoesNotTakeASyncWordWithinAMessageForAnEvent) {
  auto writer = EventLogWriter::create(path_);
  ASSERT_TRUE(writer);
  const std::string trap("\xed\xa1\xda\x01 and 24 bytes that look like no header at all", 52);
  ASSERT_TRUE(writer->write("A", bytes_of(trap), 1));
  ASSERT_TRUE(writer->write("B", bytes_of("good"), 2));
  ASSERT_TRUE(writer->flush());
  std::fstream(path_, std::ios::in | std::ios::out | std::ios::binary).write("lost", 4);
  auto reader = EventLogReader::open(path_);
  ASSERT_TRUE(reader);
  EXPECT_FALSE(reader->next());
  EXPECT_EQ(reader->recover(), 28U + 1U + 52U);
  EXPECT_EQ(reader->next().value()->channel, "B");
}

TEST_F(EventLog, FindsNothingBehindACutEnd) {
  write_three();
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 1);
  auto reader = EventLogReader::open(path_);
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->next() && reader->next());
  EXPECT_FALSE(reader->next());
  EXPECT_EQ(reader->recover(), 37U);
  EXPECT_EQ(reader->next().value(), std::nullopt);
}

TEST_F(EventLog, RefusesImpossibleLengthsAndOtherFiles) {
  write_three();
  std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(24);
  file.write("\x7f\xff\xff\xff", 4);
  file.close();
  std::string error;
  EXPECT_TRUE(read_all(&error).empty());
  EXPECT_THAT(error, HasSubstr("impossible size"));

  std::ofstream(path_) << "this is a text and certainly no log of any messages";
  EXPECT_TRUE(read_all(&error).empty());
  EXPECT_THAT(error, HasSubstr("is no LCM log"));
}

TEST_F(EventLog, SaysWhatCannotBeOpened) {
  const auto reader = EventLogReader::open(folder_.path() / "absent.lcm");
  ASSERT_FALSE(reader);
  EXPECT_THAT(reader.error().message, HasSubstr("absent.lcm: No such file"));
  EXPECT_FALSE(EventLogWriter::create(folder_.path() / "absent" / "run.lcm"));
}

}  // namespace
}  // namespace eg::transport
