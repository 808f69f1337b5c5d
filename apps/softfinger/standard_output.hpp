#pragma once

/// Where stdin, stdout or stderr is closed, opens what fails when it is used in its place: no file
/// opened later can take its number and what is printed.
void occupy_standard_streams();

/// The exit status of a command that ends with `status`: 1 with one line on stderr where what it
/// printed did not reach stdout (a full disk, a closed descriptor) and it was 0.
[[nodiscard]] int status_of_output(int status);

/// Whether something printed is known not to have reached stdout.
[[nodiscard]] bool output_is_lost();
