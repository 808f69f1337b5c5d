#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace softfinger {

/// A folder with copies of the fingers, devices and scenes, to spoil in tests. Gone afterwards.
class Workplace {
 public:
  Workplace();
  ~Workplace();
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  /// Absolute path of a file in it, e.g. "scenes/sphere.toml".
  [[nodiscard]] std::string path(const std::string& file) const { return folder_ / file; }
  void write(const std::string& file, std::string_view text) const;
  [[nodiscard]] std::string read(const std::string& file) const;
  /// Replaces the first line that starts with `begin`; returns its number, from 1.
  int replace_line(const std::string& file, std::string_view begin, std::string_view line) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace softfinger
