#include "command_table.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <sstream>

namespace {

/// Of "TEXT:{a,b}", as the parser names what takes one of these: a, b.
std::vector<std::string> choices_in(const std::string& type) {
  const std::size_t begin = type.find(":{");
  const std::size_t end = type.rfind('}');
  std::vector<std::string> choices;
  if (begin == std::string::npos || end == std::string::npos || end < begin) return choices;
  std::istringstream words(type.substr(begin + 2, end - begin - 2));
  for (std::string word; std::getline(words, word, ',');) choices.push_back(word);
  return choices;
}

OptionRow option_of(const CLI::Option& option) {
  OptionRow result;
  result.argument = option.get_positional();
  result.name = option.get_name(option.get_positional());
  if (!result.argument) result.name = "--" + option.get_lnames().front();
  const std::string type = option.get_items_expected_max() > 0 ? option.get_type_name() : "";
  result.value = type.substr(0, type.find(':'));
  result.choices = choices_in(type);
  result.help = option.get_description();
  result.required = option.get_required();
  result.repeated = option.get_items_expected_max() > 1;
  return result;
}

std::vector<OptionRow> those_of(const CommandRow& command, bool argument) {
  std::vector<OptionRow> result;
  std::ranges::copy_if(command.options, std::back_inserter(result),
                       [argument](const OptionRow& option) { return option.argument == argument; });
  return result;
}

template <typename Row>
const Row* find_named(const std::vector<Row>& rows, const std::string& name) {
  const auto found = std::ranges::find(rows, name, &Row::name);
  return found == rows.end() ? nullptr : &*found;
}

}  // namespace

const CommandRow* CommandRow::part(const std::string& wanted) const {
  return find_named(parts, wanted);
}

const OptionRow* CommandRow::option(const std::string& wanted) const {
  return find_named(options, wanted);
}

std::vector<OptionRow> CommandRow::arguments() const { return those_of(*this, true); }

std::vector<OptionRow> CommandRow::flags() const { return those_of(*this, false); }

bool CommandRow::works_itself() const {
  return parts.empty() || std::ranges::any_of(options, [](const OptionRow& option) {
           return option.name != "--help";
         });
}

CommandRow command_table(const CLI::App& app) {
  CommandRow command{
      .name = app.get_name(), .help = app.get_description(), .options = {}, .parts = {}};
  for (const CLI::Option* option : app.get_options({}))
    command.options.push_back(option_of(*option));
  for (const CLI::App* part : app.get_subcommands({})) {
    if (!part->get_group().empty()) command.parts.push_back(command_table(*part));
  }
  return command;
}
