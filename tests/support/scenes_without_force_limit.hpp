#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "folders.hpp"
#include "temporary_directory.hpp"

namespace softfinger {

/// The shipped scenes with the shipped devices, but without the devices' force limits: the tables
/// for these take long to make, above all under sanitizers.
class ScenesWithoutForceLimit {
 public:
  ScenesWithoutForceLimit() {
    namespace fs = std::filesystem;
    const fs::path shipped = source_folder();
    for (const char* folder : {"fingers", "objects"}) {
      fs::create_directory_symlink(shipped / folder, directory_ / folder);
    }
    for (const char* folder : {"scenes", "devices"}) {
      fs::create_directory(directory_ / folder);
      for (const auto& entry : fs::directory_iterator(shipped / folder)) {
        if (entry.path().extension() != ".toml") continue;
        std::ifstream original(entry.path());
        std::ofstream copy(directory_ / folder / entry.path().filename());
        for (std::string line; std::getline(original, line);) {
          if (line.rfind("max_force_N", 0) != 0) copy << line << '\n';
        }
      }
    }
  }

  /// The file of a scene, by its name.
  [[nodiscard]] std::filesystem::path scene(const std::string& name) const {
    return directory_ / "scenes" / (name + ".toml");
  }
  [[nodiscard]] std::filesystem::path device(const std::string& name) const {
    return directory_ / "devices" / (name + ".toml");
  }

 private:
  TemporaryDirectory directory_;
};

}  // namespace softfinger
