#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "command_table.hpp"
#include "commands.hpp"
#include "shipped_option.hpp"

namespace {

using softfinger::Shipped;

struct Candidate {
  std::string word, help;
};

/// Where the words before the one to complete have led.
struct Place {
  const CommandRow* command = nullptr;
  const OptionRow* awaits = nullptr;  ///< the value of this flag comes next
  std::vector<std::string> given;     ///< flags so far
  std::size_t arguments = 0;
};

Place place_after(const CommandRow& program, const std::vector<std::string>& words) {
  Place place{.command = &program, .given = {}};
  for (const std::string& word : words) {
    if (word == "=" && place.awaits != nullptr) continue;  // bash takes --flag=value apart
    if (place.awaits != nullptr) {
      place.awaits = nullptr;
    } else if (word.starts_with('-')) {
      const std::string name = word.substr(0, word.find('='));
      place.given.push_back(name);
      const OptionRow* flag = place.command->option(name);
      if (flag != nullptr && !flag->value.empty() && name == word) place.awaits = flag;
    } else if (const CommandRow* part = place.command->part(word)) {
      place.command = part;
    } else {
      ++place.arguments;
    }
  }
  return place;
}

/// None where any text or file will do.
std::vector<Candidate> values_of(const OptionRow& option) {
  const std::string& value = option.argument ? option.name : option.value;
  std::vector<Candidate> candidates;
  for (const std::string& choice : option.choices) candidates.push_back({choice, ""});
  for (const Shipped kind :
       {Shipped::kScene, Shipped::kDevice, Shipped::kFinger, Shipped::kStudy}) {
    if (value != value_name(kind)) continue;
    for (const std::string& name : softfinger::shipped_names(kind))
      candidates.push_back({name, ""});
  }
  return candidates;
}

std::vector<Candidate> parts_of(const CommandRow& command) {
  std::vector<Candidate> candidates;
  for (const CommandRow& part : command.parts) candidates.push_back({part.name, part.help});
  return candidates;
}

std::vector<Candidate> flags_of(const Place& place) {
  std::vector<Candidate> candidates;
  for (const OptionRow& flag : place.command->flags()) {
    const bool given = std::ranges::find(place.given, flag.name) != place.given.end();
    if (!given || flag.repeated) candidates.push_back({flag.name, flag.help});
  }
  return candidates;
}

std::vector<Candidate> candidates_at(const Place& place, std::string_view begun) {
  if (place.awaits != nullptr) return values_of(*place.awaits);
  if (begun.starts_with('-')) return flags_of(place);
  std::vector<Candidate> candidates;
  if (place.arguments == 0) candidates = parts_of(*place.command);
  const std::vector<OptionRow> arguments = place.command->arguments();
  if (place.arguments < arguments.size()) {
    std::ranges::move(values_of(arguments[place.arguments]), std::back_inserter(candidates));
  }
  return candidates;
}

std::vector<Candidate> completions(const CommandRow& program, std::vector<std::string> words) {
  if (words.empty()) words.emplace_back();
  std::string begun = words.back();
  words.pop_back();
  if (begun == "=") begun.clear();
  const bool explains = !words.empty() && words.front() == "help";
  if (explains) words.erase(words.begin());
  const Place place = place_after(program, words);
  std::vector<Candidate> found = explains ? parts_of(*place.command) : candidates_at(place, begun);
  std::erase_if(found, [&](const Candidate& each) { return !each.word.starts_with(begun); });
  return found;
}

}  // namespace

void add_complete_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("complete", "What a shell offers for the last word");
  command->group("");  // asked by shells, not by people
  auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("WORD", *words, "after --: those typed so far, without the program");
  command->callback([&app, words] {
    for (const Candidate& each : completions(command_table(app), *words)) {
      fmt::print("{}\t{}\n", each.word, each.help);
    }
  });
}
