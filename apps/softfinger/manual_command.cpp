#include <fmt/format.h>

#include <string>
#include <string_view>

#include "command_table.hpp"
#include "commands.hpp"

// The manual page as troff's macros for manuals have it, man(7).
namespace {

/// As text, not as troff's commands; its '-' is a hyphen, which nobody can paste into a shell.
std::string plain(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
  }
  if (result.starts_with('.') || result.starts_with('\'')) result.insert(0, "\\&");
  return result;
}

std::string bold(std::string_view text) { return "\\fB" + plain(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + plain(text) + "\\fR"; }

std::string form_of(const OptionRow& option) {
  const std::string& value = option.argument ? option.name : option.value;
  std::string form = option.argument ? "" : bold(option.name);
  if (!form.empty() && !value.empty()) form += ' ';
  if (!value.empty()) form += italic(value);
  return form;
}

std::string optional_unless_required(const OptionRow& option) {
  const std::string form = form_of(option) + (option.argument && option.repeated ? "..." : "");
  return option.required ? form : "[" + form + "]";
}

std::string synopsis_of(const std::string& name, const CommandRow& command) {
  std::string synopsis = bold(name);
  for (const OptionRow& argument : command.arguments()) {
    synopsis += ' ' + optional_unless_required(argument);
  }
  for (const OptionRow& flag : command.flags()) {
    if (flag.name != "--help") synopsis += ' ' + optional_unless_required(flag);
  }
  return synopsis;
}

std::string explanation_of(const OptionRow& option) {
  if (option.choices.empty()) return option.help;
  return fmt::format("{}; one of {}", option.help, fmt::join(option.choices, ", "));
}

void print_command(const std::string& name, const CommandRow& command) {
  for (const CommandRow& part : command.parts) print_command(name + " " + part.name, part);
  if (!command.works_itself()) return;
  fmt::print(".SS {}\n{}\n.PP\n{}.\n", plain(name), synopsis_of(name, command),
             plain(command.help));
  for (const bool argument : {true, false}) {
    for (const OptionRow& option : argument ? command.arguments() : command.flags()) {
      if (option.name == "--help") continue;
      fmt::print(".TP\n{}\n{}\n", form_of(option), plain(explanation_of(option)));
    }
  }
}

void print_manual(const CommandRow& program) {
  const std::string_view about = program.help;
  fmt::print(
      ".TH SOFTFINGER 1 \"\" \"softfinger " SOFTFINGER_VERSION
      "\" \"User Commands\"\n"
      ".nh\n.ad l\n.SH NAME\nsoftfinger \\- {}\n"
      ".SH SYNOPSIS\n.BR softfinger \" \\fICOMMAND\\fR...\"\n.PP\n"
      ".BR \"softfinger help\" \" [\\fICOMMAND\\fR...]\"\n.PP\n.B softfinger \\-\\-version\n",
      plain(about.substr(about.find(": ") + 2)));
  fmt::print(
      ".SH DESCRIPTION\n"
      "A soft finger pad touches virtual objects, and a small device under the real finger answers "
      "with the same contact.\n.PP\n"
      "{}, {} and {} are files, or names of files that come with the program: {}, {}, {}. "
      "A file of that name goes first.\n",
      italic("SCENE"), italic("DEVICE"), italic("FINGER"), bold("sphere"), bold("membrane"),
      bold("index"));
  fmt::print(".SH COMMANDS\n");
  for (const CommandRow& part : program.parts) print_command(program.name + " " + part.name, part);
  fmt::print(
      ".SH EXIT STATUS\n"
      ".TP\n0\ndone\n"
      ".TP\n1\nthe work failed, or a comparison disagrees\n"
      ".TP\n2\nwrong usage or bad input; one line on standard error says what, where and what "
      "would be right\n"
      ".SH FILES\n.TP\n{}, {}, {}\nbeside the program's folder: what comes with it\n"
      ".SH SEE ALSO\n.BR softfinger\\-guard (1)\n",
      italic("../share/softfinger/scenes"), italic("devices"), italic("fingers"));
}

}  // namespace

void add_manual_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("manual", "The manual page, softfinger(1)");
  command->group("");  // for those who make packages
  command->callback([&app] { print_manual(command_table(app)); });
}
