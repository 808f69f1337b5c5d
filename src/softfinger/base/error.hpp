#pragma once

#include <stdexcept>
#include <string>

namespace softfinger {

/// Messages quote what others wrote: control characters in it become '?', a newline too.
[[nodiscard]] std::string in_one_line(std::string text);

/// Something given from outside is wrong: a file, a flag, a mesh. what() is one line that says what
/// is wrong, where (file, line, key) and what would be right. The program exits with status 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(in_one_line(message)) {}
};

/// The work itself failed: a port that cannot be opened, a disk that is full. what() is one line.
/// The program exits with status 1.
class OperationError : public std::runtime_error {
 public:
  explicit OperationError(const std::string& message) : std::runtime_error(in_one_line(message)) {}
};

}  // namespace softfinger
