#include "help_text.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "program.hpp"

namespace softfinger {

std::set<std::string> commands_in(const std::string& help) {
  std::set<std::string> names;
  std::istringstream in(help);
  bool listed = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("Subcommands:")) {
      listed = true;
    } else if (listed && line.starts_with("  ") && line.size() > 2 && line[2] != ' ') {
      names.insert(line.substr(2, line.find(' ', 2) - 2));
    }
  }
  return names;
}

std::string help_of(std::vector<std::string> command) {
  command.emplace_back("--help");
  const ProgramRun run = run_program(command);
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(run.errors, "");
  return run.output;
}

std::vector<std::vector<std::string>> leaf_commands() {
  std::vector<std::vector<std::string>> leaves;
  for (const std::string& name : commands_in(help_of({}))) {
    if (name == "help") continue;
    const std::set<std::string> parts = commands_in(help_of({name}));
    if (parts.empty()) leaves.push_back({name});
    for (const std::string& part : parts) leaves.push_back({name, part});
  }
  return leaves;
}

}  // namespace softfinger
