#include "softfinger/files/whole_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <streambuf>

#include "softfinger/files/file_beside.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

/// What is put into a stream goes to a file that is open.
class DescriptorBuffer : public std::streambuf {
 public:
  explicit DescriptorBuffer(int descriptor) : descriptor_(descriptor) { empty(); }

 protected:
  int_type overflow(int_type c) override {
    if (sync() != 0) return traits_type::eof();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }
  int sync() override {
    for (const char* at = pbase(); at < pptr();) {
      const ssize_t written = ::write(descriptor_, at, static_cast<std::size_t>(pptr() - at));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return -1;
      at += written;
    }
    empty();
    return 0;
  }

 private:
  void empty() { setp(buffer_.data(), buffer_.data() + buffer_.size()); }

  int descriptor_;
  std::array<char, 1 << 16> buffer_;
};

/// Not every file system can: the file is whole all the same.
void keep_names_in(const fs::path& folder) {
  const int descriptor =
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

bool write_file_whole(const fs::path& file, const std::function<void(std::ostream&)>& write,
                      const WholeFileOptions& options) {
  FileBeside beside(file, options.owner_alone);
  if (beside.descriptor() < 0) return false;
  DescriptorBuffer buffer(beside.descriptor());
  std::ostream stream(&buffer);
  write(stream);
  if (!stream.flush()) return false;
  // Else the new name could last, and what it names not.
  if (options.durable && ::fsync(beside.descriptor()) != 0) return false;
  if (!beside.take_its_place()) return false;
  if (options.durable) keep_names_in(file.parent_path());
  return true;
}

}  // namespace softfinger
