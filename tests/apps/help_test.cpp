// The help lists what exists and nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "help_text.hpp"
#include "program.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

TEST(Help, ListsTheCommands) {
  std::set<std::string> names = commands_in(help_of({}));
  names.erase("help");
  EXPECT_EQ(names,
            (std::set<std::string>{"run", "press", "match", "evaluate", "device", "finger", "scene",
                                   "replay", "export", "condition", "emulate", "study"}));
}

TEST(Help, EveryCommandListedExists) {
  for (const std::string& name : commands_in(help_of({}))) {
    for (const std::string& inner : commands_in(help_of({name}))) {
      EXPECT_THAT(help_of({name, inner}), HasSubstr(inner)) << name;
    }
  }
}

TEST(Help, PartsOfCommands) {
  EXPECT_EQ(
      commands_in(help_of({"device"})),
      (std::set<std::string>{"show", "solve", "pose", "workspace", "calibrate", "schema", "fit"}));
  EXPECT_EQ(commands_in(help_of({"finger"})),
            (std::set<std::string>{"fit", "register", "schema", "show"}));
  EXPECT_EQ(commands_in(help_of({"scene"})), (std::set<std::string>{"check", "schema"}));
  EXPECT_EQ(commands_in(help_of({"emulate", "study"})),
            (std::set<std::string>{"natnet", "udp", "osc"}));
}

TEST(Help, AsACommand) {
  const ProgramRun all = run_program({"help"});
  EXPECT_EQ(all.status, 0) << all.errors;
  EXPECT_EQ(all.output, help_of({}));
  const ProgramRun one = run_program({"help", "press"});
  EXPECT_EQ(one.status, 0) << one.errors;
  EXPECT_EQ(one.output, help_of({"press"}));
  EXPECT_EQ(run_program({"help", "explode"}).status, 2);
}

TEST(Help, OfAPartOfACommand) {
  for (const std::vector<std::string>& leaf : leaf_commands()) {
    std::vector<std::string> asked{"help"};
    asked.insert(asked.end(), leaf.begin(), leaf.end());
    const ProgramRun run = run_program(asked);
    EXPECT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(run.output, help_of(leaf));
  }
  const ProgramRun wrong = run_program({"help", "device", "explode"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.errors, HasSubstr("explode"));
  EXPECT_THAT(wrong.errors, HasSubstr("softfinger help device lists them"));
}

TEST(Help, Version) {
  const ProgramRun run = run_program({"--version"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.output, testing::MatchesRegex("softfinger [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

}  // namespace
}  // namespace softfinger
