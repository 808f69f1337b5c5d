#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

/// A flag or an argument of a command.
struct OptionRow {
  std::string name;                  ///< "--json"; of an argument "SCENE"
  std::string value;                 ///< what it takes, "FLOAT", "DEVICE"; empty: nothing
  std::vector<std::string> choices;  ///< all that it takes, where they are few
  std::string help;
  bool argument = false;  ///< told from others by its place
  bool required = false;
  bool repeated = false;  ///< may be given more than once
};

/// A command, and its parts where it has any, as `softfinger help` knows them; what is hidden there
/// is not here.
struct CommandRow {
  std::string name, help;
  std::vector<OptionRow> options;
  std::vector<CommandRow> parts;

  [[nodiscard]] const CommandRow* part(const std::string& name) const;
  [[nodiscard]] const OptionRow* option(const std::string& name) const;
  /// Those told by their place, in order.
  [[nodiscard]] std::vector<OptionRow> arguments() const;
  [[nodiscard]] std::vector<OptionRow> flags() const;
  /// Not only its parts do.
  [[nodiscard]] bool works_itself() const;
};

[[nodiscard]] CommandRow command_table(const CLI::App& app);
