#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace softfinger {

/// A new file beside another one, gone unless it took that one's place. Its name nobody can
/// foresee: in a folder that others may write to, a link planted there would lead it elsewhere.
class FileBeside {
 public:
  /// `owner_alone`: nobody else may read it; else as the umask says.
  explicit FileBeside(const std::filesystem::path& file, bool owner_alone = false);
  ~FileBeside();
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;

  /// For reading and writing; negative where it could not be made.
  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// All of it, or false. `offset`: bytes from its begin.
  [[nodiscard]] bool write(const void* data, std::size_t size, std::uint64_t offset);
  [[nodiscard]] bool take_its_place();

 private:
  std::filesystem::path file_;
  std::string name_;
  int descriptor_ = -1;
  bool in_place_ = false;
};

}  // namespace softfinger
