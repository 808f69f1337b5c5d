// What a shell offers is what the help tells.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "help_text.hpp"
#include "program.hpp"

namespace softfinger {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsSubsetOf;
using testing::Not;
using testing::UnorderedElementsAre;

using Words = std::vector<std::string>;

/// What is offered for the last of the words.
std::set<std::string> offered(Words words) {
  words.insert(words.begin(), {"complete", "--"});
  const ProgramRun run = run_program(words);
  EXPECT_EQ(run.status, 0) << run.errors;
  std::set<std::string> found;
  std::istringstream lines(run.output);
  for (std::string line; std::getline(lines, line);) found.insert(line.substr(0, line.find('\t')));
  return found;
}

std::set<std::string> flags_in(const std::string& help) {
  static const std::regex flag("\n  (-h,)?(--[a-zA-Z-]+)");
  std::set<std::string> flags;
  for (auto it = std::sregex_iterator(help.begin(), help.end(), flag); it != std::sregex_iterator();
       ++it) {
    flags.insert((*it)[2]);
  }
  return flags;
}

TEST(Completion, EveryFlagOfEveryCommand) {
  std::size_t flags = 0;
  for (Words leaf : leaf_commands()) {
    const std::set<std::string> told = flags_in(help_of(leaf));
    flags += told.size();
    const std::string name = testing::PrintToString(leaf);
    leaf.emplace_back("--");
    EXPECT_EQ(offered(leaf), told) << name;
  }
  EXPECT_GT(flags, 100u);
}

TEST(Completion, EveryCommandAndPart) {
  EXPECT_EQ(offered({""}), commands_in(help_of({})));
  EXPECT_EQ(offered({"device", ""}), commands_in(help_of({"device"})));
  EXPECT_EQ(offered({"help", "device", ""}), commands_in(help_of({"device"})));
  EXPECT_THAT(offered({"ex"}), ElementsAre("export"));
  EXPECT_THAT(offered({"export", ""}), ElementsAre());  // any file
}

TEST(Completion, NamesOfShippedFilesWhereAFileOfTheirKindIsTaken) {
  EXPECT_THAT(offered({"run", ""}), Contains("sphere"));
  EXPECT_THAT(offered({"press", "index-"}), Contains("index-fine"));
  EXPECT_THAT(offered({"match", "thimble-3rrs-w"}), ElementsAre("thimble-3rrs-weart"));
  EXPECT_THAT(offered({"device", "solve", "mem"}), ElementsAre("membrane"));
  EXPECT_THAT(offered({"run", "sphere", "--device", "mem"}), ElementsAre("membrane"));
  EXPECT_THAT(offered({"evaluate", "--wearer", "=", "th"}),
              ElementsAre("thumb"));  // as bash has it
  EXPECT_THAT(offered({"replay", "a.sqlite", "--scene", "="}), Contains("edge"));
  // One scene is enough, and after the value of a flag it is the scene's turn again.
  EXPECT_THAT(offered({"run", "sphere", ""}), ElementsAre());
  EXPECT_THAT(offered({"run", "--duration-s", "2", "sph"}), ElementsAre("sphere"));
}

TEST(Completion, ChoicesOfAFlag) {
  EXPECT_THAT(offered({"match", "--limits", ""}), UnorderedElementsAre("inside", "clamp", "none"));
}

TEST(Completion, AFlagThatMayBeGivenOnceIsOfferedOnce) {
  const std::set<std::string> next =
      offered({"run", "--json", "--device=membrane", "--duration-s", "2", "--"});
  EXPECT_THAT(next, Not(Contains("--json")));
  EXPECT_THAT(next, Not(Contains("--duration-s")));
  EXPECT_THAT((Words{"--device", "--headless"}), IsSubsetOf(next));  // --device: of each finger
}

TEST(Completion, WhatShellsAskIsNotTold) {
  for (const char* hidden : {"complete", "manual"}) {
    EXPECT_THAT(commands_in(help_of({})), Not(Contains(hidden)));
    EXPECT_THAT(offered({""}), Not(Contains(hidden)));
  }
}

}  // namespace
}  // namespace softfinger
