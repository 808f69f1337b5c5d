#include "standard_output.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

void occupy_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) != -1) continue;
    // The lowest free number, which is this one; reading from stdin and writing to the others fail.
    (void)::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

bool output_is_lost() { return std::ferror(stdout) != 0 || !std::cout; }

int status_of_output(int status) {
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && !output_is_lost()) return status;
  fmt::print(
      stderr,
      "softfinger: the output cannot be written (is there room on the disk, and somebody who "
      "reads it?)\n");
  return status == 0 ? 1 : status;
}
