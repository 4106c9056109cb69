#include "common/io/journal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "common/io/text_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::io {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kSchema = 0x1234567890abcdefULL;

std::vector<std::string> texts(const JournalContents& contents) {
  std::vector<std::string> found;
  for (const JournalRecord& record : contents.records) found.emplace_back(record.bytes);
  return found;
}

std::string three_records() {
  const std::vector<JournalRecord> records = {{0, "first"}, {1, ""}, {7, "the third"}};
  return format_journal(kSchema, records);
}

TEST(Journal, GivesBackWhatWasWritten) {
  const std::string bytes = three_records();
  const auto contents = parse_journal(bytes, kSchema);
  ASSERT_TRUE(contents.has_value()) << contents.error().message;
  EXPECT_EQ(texts(*contents), (std::vector<std::string>{"first", "", "the third"}));
  EXPECT_EQ(contents->records[2].kind, 7);
  EXPECT_EQ(contents->sound_bytes, bytes.size());
  EXPECT_EQ(contents->damage, "");
}

TEST(Journal, IsReadRecordByRecord) {
  test::TemporaryFolder folder;
  const std::string sound = three_records();
  const auto path = folder.write("a.journal", sound);
  std::vector<std::string> found;
  const auto take = [&](const JournalRecord& record) -> base::Status {
    found.emplace_back(record.bytes);
    return record.kind == 9 ? base::fail("is not wanted") : base::Status();
  };
  ASSERT_TRUE(read_journal(path, kSchema, take));
  EXPECT_EQ(found, (std::vector<std::string>{"first", "", "the third"}));

  const auto error = [&](const std::string& bytes) {
    const auto read = read_journal(folder.write("a.journal", bytes), kSchema, take);
    return read ? "" : read.error().message;
  };
  EXPECT_THAT(error(format_journal(kSchema, std::vector<JournalRecord>{{1, "a"}, {9, "b"}})),
              HasSubstr("a.journal: record 1: is not wanted"));
  EXPECT_THAT(error(format_journal(kSchema + 1, {})), HasSubstr("a.journal: "));
  for (std::size_t size = 0; size < sound.size(); ++size) {
    const auto contents = parse_journal(sound.substr(0, size), kSchema);
    EXPECT_EQ(error(sound.substr(0, size)).empty(), contents && contents->damage.empty()) << size;
  }
  std::string damaged = sound;
  damaged.back() ^= 1;
  EXPECT_THAT(error(damaged), HasSubstr("a.journal: record 2 has a wrong checksum"));
  EXPECT_FALSE(read_journal(folder.path() / "none", kSchema, take));
}

TEST(Journal, GoesOnInAFile) {
  test::TemporaryFolder folder;
  const auto path = folder.path() / "a.journal";
  {
    auto journal = Journal::create(path, kSchema, {});
    ASSERT_TRUE(journal.has_value()) << journal.error().message;
    ASSERT_TRUE(journal->append({1, "one"}).has_value());
    ASSERT_TRUE(journal->append({1, "two"}).has_value());
    EXPECT_EQ(journal->size(), std::filesystem::file_size(path));
  }
  std::string bytes = read_file(path).value();
  auto contents = parse_journal(bytes, kSchema);
  ASSERT_TRUE(contents.has_value());
  auto journal = Journal::open(path, contents->sound_bytes - 1);  // cuts into "two"
  ASSERT_TRUE(journal.has_value());
  bytes = read_file(path).value();
  EXPECT_EQ(texts(*parse_journal(bytes, kSchema)), std::vector<std::string>{"one"});
}

TEST(Journal, EveryCutLeavesTheRecordsBeforeIt) {
  const std::string bytes = three_records();
  const std::vector<std::string> all = texts(*parse_journal(bytes, kSchema));
  std::size_t most = 0;
  for (std::size_t length = 16; length < bytes.size(); ++length) {
    const auto contents = parse_journal(std::string_view(bytes).substr(0, length), kSchema);
    ASSERT_TRUE(contents.has_value());
    const std::vector<std::string> left = texts(*contents);
    EXPECT_TRUE(std::equal(left.begin(), left.end(), all.begin()));
    EXPECT_EQ(contents->damage.empty(), contents->sound_bytes == length);
    most = std::max(most, left.size());
  }
  EXPECT_EQ(most, 2U);
}

TEST(Journal, EveryBitThatTurnsOverIsFound) {
  const std::string bytes = three_records();
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string wrong = bytes;
    wrong[bit / 8] = static_cast<char>(wrong[bit / 8] ^ (1 << (bit % 8)));
    const auto contents = parse_journal(wrong, kSchema);
    EXPECT_TRUE(!contents.has_value() || !contents->damage.empty()) << "bit " << bit;
  }
}

TEST(Journal, SaysWhatItRefuses) {
  EXPECT_THAT(parse_journal("", kSchema).error().message, HasSubstr("is no journal"));
  EXPECT_THAT(parse_journal("some other file altogether", kSchema).error().message, HasSubstr("is no journal"));
  std::string bytes = three_records();
  bytes[7] = 2;
  EXPECT_THAT(parse_journal(bytes, kSchema).error().message, HasSubstr("format version 2, not 1"));
  EXPECT_THAT(parse_journal(three_records(), kSchema + 1).error().message, HasSubstr("other message types"));
  EXPECT_EQ(parse_journal(three_records() + "x", kSchema)->damage, "record 3 is cut short");
}

TEST(Journal, ChecksTheBeginningOfAFile) {
  test::TemporaryFolder folder;
  EXPECT_TRUE(check_journal(folder.write("good", three_records()), kSchema).has_value());
  EXPECT_THAT(check_journal(folder.write("bad", "egg"), kSchema).error().message, HasSubstr("bad: is no journal"));
  EXPECT_THAT(check_journal(folder.path() / "none", kSchema).error().message, HasSubstr("none: cannot be read"));
}

}  // namespace
}  // namespace eg::io
