#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "softfinger/base/error.hpp"

void add_help_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("help", "Explain a command, or list them all");
  auto names = std::make_shared<std::vector<std::string>>();
  command->add_option("COMMAND", *names, "which one, and which part of it: device calibrate");
  command->callback([&app, names] {
    const CLI::App* explained = &app;
    std::string title = app.get_name();
    for (const std::string& name : *names) {
      const auto parts = explained->get_subcommands([](const CLI::App*) { return true; });
      const auto found = std::ranges::find(parts, name, &CLI::App::get_name);
      if (found == parts.end()) {
        throw softfinger::InputError(
            fmt::format("help: no command {} of {}; softfinger help{} lists them", name, title,
                        title.substr(app.get_name().size())));
      }
      explained = *found;
      title += " " + name;
    }
    // App::help() would explain the command that was given, which is this one.
    fmt::print("{}", app.get_formatter()->make_help(explained, title, CLI::AppFormatMode::Normal));
  });
}
