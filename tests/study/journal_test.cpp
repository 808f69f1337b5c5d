// A journal that is cut, spoilt or of something else loses no more than it must, and says so.
#include "softfinger/study/journal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <fstream>
#include <string>

#include "study_place.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A journal of a hundred outcomes.
class JournalFile : public testing::Test {
 protected:
  JournalFile() {
    Journal journal = open();
    for (std::uint64_t key = 1; key <= 100; ++key) journal.add(key * kFar, outcome(key));
  }
  [[nodiscard]] Journal open() {
    return {place_.at("out"), {}, facts_, {}, [this](const std::string& line) {
              told_.push_back(line);
            }};
  }
  [[nodiscard]] static CaseOutcome outcome(std::uint64_t key) {
    return {.reason = std::string(key % 7, 'x'), .values = {static_cast<double>(key), 0.5}};
  }
  /// All that is in one file.
  [[nodiscard]] fs::path file() {
    open().finish();
    told_.clear();
    return place_.at("out") / "journal.sqlite";
  }
  [[nodiscard]] int known(const Journal& journal) const {
    int count = 0;
    for (std::uint64_t key = 1; key <= 100; ++key) {
      const CaseOutcome* found = journal.find(key * kFar);
      if (found == nullptr) continue;
      ++count;
      EXPECT_EQ(found->reason, outcome(key).reason);
      EXPECT_EQ(found->values, outcome(key).values);
    }
    return count;
  }

  static constexpr std::uint64_t kFar = 0x9e3779b97f4a7c15ull;
  StudyPlace place_;
  std::vector<StudyFact> facts_{{"the program", "1"}, {"study.toml", "2"}};
  std::vector<std::string> told_;
};

TEST_F(JournalFile, RemembersEveryOutcome) {
  EXPECT_EQ(known(open()), 100);
  EXPECT_THAT(told_, IsEmpty());
}

TEST_F(JournalFile, OfOneThatIsCutWhatIsThereIsKept) {
  {
    Journal journal = open();
    for (std::uint64_t key = 101; key <= 1000; ++key) journal.add(key * kFar, outcome(key));
  }
  const fs::path journal = file();
  fs::resize_file(journal, fs::file_size(journal) / 2);
  {
    const Journal again = open();
    EXPECT_EQ(known(again), 100) << "recorded first";
    EXPECT_EQ(again.find(1000 * kFar), nullptr);
  }
  ASSERT_EQ(told_.size(), 1u);
  EXPECT_THAT(told_[0], HasSubstr("journal.sqlite: is damaged"));
  EXPECT_THAT(told_[0], HasSubstr("journal-damaged-1.sqlite"));
  EXPECT_TRUE(fs::exists(place_.at("out") / "journal-damaged-1.sqlite"));
  told_.clear();
  static_cast<void>(open());
  EXPECT_THAT(told_, IsEmpty()) << "it is whole again";
}

// A flipped bit is noticed wherever it is: an outcome is never another one.
TEST_F(JournalFile, OfOneThatIsSpoiltWhatIsBeforeIsKept) {
  const fs::path journal = file();
  const std::string good = place_.read(journal);
  int damaged = 0;
  for (std::size_t at = 4096; at < good.size(); at += 977) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    std::ofstream(journal, std::ios::binary) << bad;
    told_.clear();
    try {
      const Journal again = open();
      if (known(again) < 100) {
        ++damaged;
        EXPECT_FALSE(told_.empty()) << at;
      }
    } catch (const InputError& error) {
      // A fact may be what is spoilt.
      EXPECT_THAT(error.what(), HasSubstr("journal.sqlite"));
    }
  }
  EXPECT_GT(damaged, 0);
}

TEST_F(JournalFile, WhatIsNoDatabaseIsSetAside) {
  std::ofstream(file(), std::ios::binary) << "not a database, by far not a database at all";
  EXPECT_EQ(known(open()), 0);
  EXPECT_THAT(told_, ElementsAre(HasSubstr("is damaged; 0 outcomes")));
}

TEST_F(JournalFile, NamesWhatChanged) {
  const auto refusal = [this] {
    try {
      static_cast<void>(open());
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  facts_ = {{"the program", "9"}, {"study.toml", "2"}};
  EXPECT_THAT(refusal(), HasSubstr("was begun by another build of the program"));
  facts_ = {{"the program", "1"}, {"study.toml", "3"}};
  EXPECT_THAT(refusal(), HasSubstr("another content of study.toml"));
  facts_ = {{"the program", "1"}};
  EXPECT_THAT(refusal(), HasSubstr("study.toml, which is no longer part"));
  facts_ = {{"the program", "1"}, {"study.toml", "2"}, {"more.msh", "4"}};
  EXPECT_THAT(refusal(), HasSubstr("another content of more.msh"));
  facts_ = {{"the program", "1"}, {"study.toml", "2"}};
  EXPECT_EQ(refusal(), "");
}

TEST_F(JournalFile, AFolderThatIsAFileIsRefused) {
  place_.write("file", "");
  EXPECT_THROW(Journal(place_.at("file"), {}, facts_, {}, [](const std::string&) {}), InputError);
}

}  // namespace
}  // namespace softfinger
