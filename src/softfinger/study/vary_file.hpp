#pragma once

#include "softfinger/files/config_file.hpp"
#include "softfinger/study/file_numbers.hpp"
#include "softfinger/study/study.hpp"

namespace softfinger {

/// Reads `[vary]` into the study's parameters, in the order of the file, keys of one table
/// together. The study has its files and its plan. Throws InputError with file, line and key.
void read_vary(const ConfigTable& vary, Study& study, FileNumbers& numbers);

}  // namespace softfinger
