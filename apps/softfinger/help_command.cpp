#include <fmt/core.h>

#include <memory>
#include <string>

#include "commands.hpp"
#include "softfinger/base/error.hpp"

void add_help_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("help", "Explain a command, or list them all");
  auto name = std::make_shared<std::string>();
  command->add_option("COMMAND", *name, "which one");
  command->callback([&app, name] {
    // App::help() would explain the command that was given, which is this one.
    const auto help_of = [&app](const CLI::App* explained, const std::string& title) {
      fmt::print("{}",
                 app.get_formatter()->make_help(explained, title, CLI::AppFormatMode::Normal));
    };
    if (name->empty()) return help_of(&app, app.get_name());
    for (const CLI::App* explained : app.get_subcommands([](const CLI::App*) { return true; })) {
      if (explained->get_name() == *name) {
        return help_of(explained, app.get_name() + " " + *name);
      }
    }
    throw softfinger::InputError("help: no command " + *name + "; softfinger help lists them");
  });
}
