#include <fmt/core.h>

#include <memory>
#include <string>

#include "commands.hpp"
#include "softfinger/recording/csv_export.hpp"

void add_export_command(CLI::App& app) {
  struct Flags {
    std::string recording, directory;
  };
  CLI::App* command = app.add_subcommand("export", "Write a recording as CSV files");
  auto flags = std::make_shared<Flags>();
  command->add_option("RECORDING", flags->recording, "what run --record wrote")->required();
  command->add_option("--to", flags->directory, "directory for the files; made if absent")
      ->required();
  command->callback([flags] {
    const std::string cut = softfinger::export_csv(flags->recording, flags->directory);
    if (!cut.empty()) fmt::print(stderr, "softfinger: {}\n", cut);
  });
}
