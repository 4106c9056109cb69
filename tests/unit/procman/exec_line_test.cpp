#include "common/procman/exec_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eg::procman {
namespace {

using testing::ElementsAre;
using testing::Pair;

std::optional<std::string> look_up(const std::string& name) {
  if (name == "HOME") return "/home/me";
  if (name == "SPACED") return "a b";
  if (name == "EMPTY") return "";
  return std::nullopt;
}

std::vector<std::string> words(const std::string& exec) {
  const auto line = parse_exec(exec, look_up);
  EXPECT_TRUE(line) << exec;
  return line ? line->words : std::vector<std::string>{};
}

TEST(ExecLine, SplitsLikeAShell) {
  EXPECT_THAT(words("  a   b\tc "), ElementsAre("a", "b", "c"));
  EXPECT_THAT(words("a 'b c' \"d e\" f' 'g"), ElementsAre("a", "b c", "d e", "f g"));
  EXPECT_THAT(words("a '' \"\""), ElementsAre("a", "", ""));
  EXPECT_THAT(words(R"(a\ b 'c\d' "e\"f" "g\h" \\)"), ElementsAre("a b", "c\\d", "e\"f", "g\\h", "\\"));
  EXPECT_THAT(words("ls *.txt | wc #x"), ElementsAre("ls", "*.txt", "|", "wc", "#x"));
}

TEST(ExecLine, ReplacesKnownVariablesOnly) {
  EXPECT_THAT(words("$HOME/bin ${HOME}x"), ElementsAre("/home/me/bin", "/home/mex"));
  EXPECT_THAT(words("a$SPACED"), ElementsAre("aa b"));
  EXPECT_THAT(words("x$EMPTY"), ElementsAre("x"));
  EXPECT_THAT(words("$NONE ${NONE} $HOMES $ $$ ${HOME $1"),
              ElementsAre("$NONE", "${NONE}", "$HOMES", "$", "$$", "${HOME", "$1"));
}

TEST(ExecLine, TakesLeadingAssignmentsAsEnvironment) {
  const auto line = parse_exec("A=1 B_2='x y' C=$HOME prog D=4", look_up);
  ASSERT_TRUE(line);
  EXPECT_THAT(line->environment, ElementsAre(Pair("A", "1"), Pair("B_2", "x y"), Pair("C", "/home/me")));
  EXPECT_THAT(line->words, ElementsAre("prog", "D=4"));
  EXPECT_THAT(words("=a 1A=2"), ElementsAre("=a", "1A=2"));
}

TEST(ExecLine, RejectsWhatCannotBeRun) {
  EXPECT_FALSE(parse_exec("", look_up));
  EXPECT_FALSE(parse_exec("A=1", look_up));
  EXPECT_FALSE(parse_exec("a 'b", look_up));
  EXPECT_FALSE(parse_exec("a \"b", look_up));
  EXPECT_FALSE(parse_exec("a \\", look_up));
}

}  // namespace
}  // namespace eg::procman
