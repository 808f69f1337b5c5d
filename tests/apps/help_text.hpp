#pragma once

#include <set>
#include <string>
#include <vector>

namespace softfinger {

/// Names under "Subcommands:" in a help text.
[[nodiscard]] std::set<std::string> commands_in(const std::string& help);

/// What `COMMAND --help` prints.
[[nodiscard]] std::string help_of(std::vector<std::string> command);

/// Every command that does work, with its parts: {"run"}, {"device", "show"}; without "help".
[[nodiscard]] std::vector<std::vector<std::string>> leaf_commands();

}  // namespace softfinger
