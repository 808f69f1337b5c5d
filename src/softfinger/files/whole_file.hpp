#pragma once

#include <filesystem>
#include <functional>
#include <ostream>

namespace softfinger {

struct WholeFileOptions {
  bool owner_alone = false;  ///< nobody else may read it; else as the umask says
  bool durable = false;      ///< outlasts a loss of power; else as the system likes
};

/// Puts what `write` writes in the place of `file`, as a whole or not at all; false where that does
/// not work. Meanwhile it has a name beside it that nobody can foresee: in a folder that others
/// may write to, a link planted there would lead it elsewhere.
[[nodiscard]] bool write_file_whole(const std::filesystem::path& file,
                                    const std::function<void(std::ostream&)>& write,
                                    const WholeFileOptions& options = {});

}  // namespace softfinger
