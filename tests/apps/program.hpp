#pragma once

#include <string>
#include <vector>

namespace softfinger {

/// What the program said and how it ended.
struct ProgramRun {
  int status = -1;  ///< exit status; 128 + signal where one ended it
  std::string output, errors;
};

/// Runs build/softfinger with these arguments and waits for it.
[[nodiscard]] ProgramRun run_program(const std::vector<std::string>& arguments);

/// Refused as bad input: status 2, nothing said but one line with all of `words` in it.
void expect_refused(const ProgramRun& run, const std::vector<std::string>& words);

/// Runs a line of bash, in which "$@" is the program with these arguments, and waits for it:
/// `exec "$@" >/dev/full`.
[[nodiscard]] ProgramRun run_in_shell(const std::string& line,
                                      const std::vector<std::string>& arguments);

/// The same, started and left running until stop().
class RunningProgram {
 public:
  /// `shell_line`: as for run_in_shell(); empty: the program alone.
  explicit RunningProgram(const std::vector<std::string>& arguments,
                          const std::string& shell_line = {});
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  /// Waits until it has written `text` to stdout or stderr; false after `seconds` or when it has
  /// ended without.
  [[nodiscard]] bool says(const std::string& text, double seconds);
  /// What it has written to stdout so far.
  [[nodiscard]] std::string output() const;
  [[nodiscard]] int process() const { return process_; }
  /// Sends the signal (0: none) and waits for the end.
  ProgramRun stop(int signal);

 private:
  [[nodiscard]] bool ended();

  int process_ = -1;
  int wait_status_ = 0;
  bool reaped_ = false;
  std::string output_file_, errors_file_;
};

}  // namespace softfinger
