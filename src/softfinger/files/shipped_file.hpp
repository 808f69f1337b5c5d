#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger {

/// What comes with softfinger, as files.
enum class Shipped { kScene, kDevice, kFinger, kStudy };

/// The file that a word means which somebody gave: a file of that name, else the shipped one.
///
/// Names of shipped files are words without '/' and '.': "sphere" is sphere.toml in the folder of
/// shipped scenes. Any other word is a path and comes back as it is, whether there is such a file
/// or not. Throws InputError where a name is neither, with where it was looked for and names near.
[[nodiscard]] std::filesystem::path file_or_shipped(Shipped kind, std::string_view word);

/// Names of all shipped files of a kind, sorted; empty where none are found.
[[nodiscard]] std::vector<std::string> shipped_names(Shipped kind);

/// Of `names`, those a word may have meant: that contain it, else the one with the fewest letters
/// changed; all where none is near.
[[nodiscard]] std::vector<std::string> names_near(std::string_view word,
                                                  const std::vector<std::string>& names);

/// The folder of the program or the shared library that this function is part of; where softfinger
/// is installed, bin or lib.
[[nodiscard]] std::filesystem::path own_folder();

}  // namespace softfinger
