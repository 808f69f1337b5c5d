#include "softfinger/files/whole_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "../support/temporary_directory.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool write(const fs::path& file, const std::string& text, const WholeFileOptions& options = {}) {
  return write_file_whole(
      file, [&](std::ostream& stream) { stream << text; }, options);
}

std::ptrdiff_t files_beside(const fs::path& file) {
  return std::distance(fs::directory_iterator(file.parent_path()), {});
}

TEST(WholeFile, TakesThePlaceOfTheOldOneWithAllItsContent) {
  const TemporaryDirectory directory;
  const fs::path file = directory / "file";
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i) + '\n';
  EXPECT_TRUE(write(file, "old"));
  EXPECT_TRUE(write(file, text, {.owner_alone = true, .durable = true}));
  EXPECT_EQ(content_of(file), text);
  EXPECT_EQ(files_beside(file), 1);
}

TEST(WholeFile, WhatFailsLeavesTheOldOneAndNothingBeside) {
  const TemporaryDirectory directory;
  const fs::path file = directory / "file";
  EXPECT_TRUE(write(file, "old"));
  EXPECT_FALSE(
      write_file_whole(file, [](std::ostream& stream) { stream.setstate(std::ios::badbit); }, {}));
  EXPECT_THROW(static_cast<void>(write_file_whole(
                   file, [](std::ostream&) { throw std::runtime_error("no"); }, {})),
               std::runtime_error);
  EXPECT_EQ(content_of(file), "old");
  EXPECT_EQ(files_beside(file), 1);
  EXPECT_FALSE(write(directory / "no such folder" / "file", "text"));
}

TEST(WholeFile, ALinkAtANameThatCouldBeForeseenIsNotFollowed) {
  const TemporaryDirectory directory;
  const fs::path file = directory / "file";
  const fs::path other = directory / "other";
  EXPECT_TRUE(write(other, "of somebody else"));
  const fs::path link = file.string() + "." + std::to_string(::getpid());
  fs::create_symlink(other, link);
  EXPECT_TRUE(write(file, "text"));
  EXPECT_EQ(content_of(other), "of somebody else");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_FALSE(fs::is_symlink(file));
  EXPECT_EQ(content_of(file), "text");
}

TEST(WholeFile, IsItsOwnersAloneWhereAskedFor) {
  const TemporaryDirectory directory;
  const fs::path file = directory / "file";
  const mode_t before = ::umask(0022);
  EXPECT_TRUE(write(file, "text"));
  EXPECT_EQ(fs::status(file).permissions(), fs::perms{0644});
  EXPECT_TRUE(write(file, "text", {.owner_alone = true}));
  EXPECT_EQ(fs::status(file).permissions(), fs::perms{0600});
  ::umask(before);
}

}  // namespace
}  // namespace softfinger
