#pragma once

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/study/run_study.hpp"
#include "softfinger/study/study_table.hpp"

namespace softfinger {

/// A folder with a study in it, whose device and scenes are the shipped ones.
class StudyPlace {
 public:
  /// A study of formulas alone: the device is read, and nothing is touched.
  static constexpr const char* kVaryTwo =
      "device = \"membrane\"\n"
      "[vary]\n"
      "device.mount.translation_mm.0 = { min = 0, max = 1 }\n"
      "device.mount.translation_mm.1 = { min = 0, max = 1 }\n";

  [[nodiscard]] std::filesystem::path at(const char* name) const { return folder_ / name; }
  std::filesystem::path write(const char* name, std::string_view text) const {
    std::ofstream(at(name)) << text;
    return at(name);
  }
  [[nodiscard]] std::string read(const std::filesystem::path& file) const {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  [[nodiscard]] Study study(std::string_view text) const {
    return load_study(write("study.toml", text));
  }
  /// What is said of such a study; empty: nothing.
  [[nodiscard]] std::string refusal(std::string_view text) const {
    try {
      static_cast<void>(study(text));
      return {};
    } catch (const InputError& error) {
      return error.what();
    }
  }
  /// Runs what is in study.toml into `out`, says what it was told.
  StudySummary run(const char* out = "out", const std::optional<Shard>& shard = {}) {
    OneRank one;
    return run(out, shard, one);
  }
  StudySummary run(const char* out, const std::optional<Shard>& shard, Ranks& ranks) {
    const StudyObserver observer{
        .message = [this](const std::string& line) { told.push_back(line); }};
    return run_study(load_study(at("study.toml")), {at(out), shard}, ranks, stop, observer);
  }
  StudyTable run_all(std::string_view text) {
    write("study.toml", text);
    static_cast<void>(run());
    return read_study_table(at("out"));
  }
  /// The study's table as CSV.
  [[nodiscard]] std::string csv(const char* out = "out") const {
    const auto file = at("table.csv");
    std::filesystem::remove(file);
    export_study(read_study_table(at(out)), file);
    return read(file);
  }

  std::vector<std::string> told;
  std::atomic<bool> stop{false};

 private:
  TemporaryDirectory folder_;
};

}  // namespace softfinger
