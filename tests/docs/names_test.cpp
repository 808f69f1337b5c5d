// What the pages list by name is what the tables have: every name, and no other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/actuation/device_state.hpp"
#include "softfinger/base/instruction_set.hpp"
#include "softfinger/device/kinds/device_kinds.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/geometry/mesh_units.hpp"
#include "softfinger/geometry/shape_names.hpp"
#include "softfinger/motors/motor_kinds.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/recording/latency_stages.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace softfinger {
namespace {

using testing::ElementsAreArray;
using testing::UnorderedElementsAreArray;

std::string source(const std::string& name) {
  return read_text_file(std::filesystem::path(source_folder()) / name, 1 << 20);
}

/// From a mark to the next end; empty where the mark is not there.
std::string part(const std::string& text, const std::string& mark, const std::string& end) {
  const std::size_t begin = text.find(mark);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find(end, begin + mark.size()) - begin);
}

/// The text under a heading of a page, up to the next of its level.
std::string section(const std::string& page, const std::string& heading) {
  const std::string level = heading.substr(0, heading.find(' ') + 1);
  return part(source("docs/" + page), "\n" + heading + "\n", "\n" + level);
}

/// What `pattern` catches first, wherever it stands in a text.
std::vector<std::string> all(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at) {
    found.push_back((*at)[1]);
  }
  return found;
}

/// Words of code in a cell, without quotes.
std::vector<std::string> code(const std::string& cell) { return all(cell, "`\"?([^`\"]+)\"?`"); }

/// Cells of one column, from the table whose head begins with this; column 0 is the first.
std::vector<std::string> column(const std::string& text, const std::string& head, int column) {
  std::vector<std::string> cells;
  std::size_t line = text.find("\n| " + head + " |");
  while (line != std::string::npos && text.compare(line, 3, "\n| ") == 0) {
    std::size_t begin = line + 3;
    for (int k = 0; k < column; ++k) begin = text.find(" | ", begin) + 3;
    cells.push_back(text.substr(begin, text.find(" |", begin) - begin));
    line = text.find('\n', line + 1);
  }
  if (cells.size() > 2) cells.erase(cells.begin(), cells.begin() + 2);  // head and rule
  return cells;
}

/// Names of code that fill a column.
std::vector<std::string> names(const std::string& text, const std::string& head) {
  std::vector<std::string> found;
  for (const std::string& cell : column(text, head, 0)) {
    for (const std::string& name : code(cell)) found.push_back(name);
  }
  return found;
}

/// Values of a key in a table of keys.
std::vector<std::string> values(const std::string& text, const std::string& key) {
  const std::vector<std::string> rows = all(text, ("\n\\| `" + key + "` \\| ([^|]*) \\|").c_str());
  return rows.empty() ? rows : code(rows.front());
}

template <typename Table>
std::vector<std::string> words_of(const Table& table) {
  std::vector<std::string> words;
  for (const auto& row : table) words.emplace_back(row.words);
  return words;
}

std::vector<std::string> without_links(std::vector<std::string> cells) {
  for (std::string& cell : cells) {
    cell = std::regex_replace(cell, std::regex("\\[([^\\]]*)\\]\\([^)]*\\)"), "$1");
  }
  return cells;
}

TEST(NamesOnPages, TrackersInEveryForm) {
  const std::string page = source("docs/trackers.md");
  std::vector<std::string> forms;
  std::vector<std::string> sent;
  for (const TrackerRow& row : kTrackers) {
    forms.emplace_back(row.form);
    if (row.origin == PoseOrigin::kNetwork) sent.emplace_back(row.name);
  }
  EXPECT_THAT(names(page, "tracker | poses come from"), ElementsAreArray(forms));
  EXPECT_THAT(without_links(column(page, "tracker | poses come from", 1)),
              ElementsAreArray(words_of(kTrackers)));
  EXPECT_THAT(names(page, "tracker | in one terminal"), UnorderedElementsAreArray(sent));
  std::vector<std::string> of_scenes = values(section("files.md", "## Scene"), "tracker");
  for (std::string& form : of_scenes) form = form.substr(0, form.find_first_of(":["));
  EXPECT_THAT(of_scenes, ElementsAreArray(names_of(kTrackers)));
}

TEST(NamesOnPages, SidesAndFingersOfHands) {
  const std::string sides =
      part(section("headsets.md", "## The tracker"), "HAND is ", ", a finger");
  EXPECT_THAT(code(sides), ElementsAreArray(names_of(kHandSides)));
  const std::string fingers = part(section("headsets.md", "## The tracker"), ", a finger (", ")");
  EXPECT_THAT(code(fingers), ElementsAreArray(names_of(kHandFingers)));
}

TEST(NamesOnPages, Devices) {
  const std::string device = section("files.md", "## Device");
  EXPECT_THAT(names(device, "kind | configuration"),
              UnorderedElementsAreArray(device_kind_names()));
}

TEST(NamesOnPages, Objectives) {
  std::vector<std::string> every;
  for (const ObjectiveKind& kind : objective_kinds()) {
    every.emplace_back(kind.name);
  }
  EXPECT_THAT(values(section("files.md", "## Device"), "objective"), ElementsAreArray(every));
  const std::string flag = part(section("command-line.md", "## evaluate"), "`--objective`\n(", ")");
  EXPECT_THAT(code(part(flag, "(", ")")), ElementsAreArray(every));
}

TEST(NamesOnPages, Motors) {
  EXPECT_THAT(names(source("docs/motors.md"), "`[transport] kind` | hardware"),
              ElementsAreArray(transport_kinds()));
  EXPECT_THAT(values(section("files.md", "### Transport"), "kind"),
              ElementsAreArray(transport_kinds()));
}

TEST(NamesOnPages, ShapesAndUnitsOfObjects) {
  const std::string scene = section("files.md", "## Scene");
  std::vector<std::string> shapes = object_shape_names();
  shapes.emplace_back(kSoftShape);
  EXPECT_THAT(values(scene, "shape"), ElementsAreArray(shapes));
  EXPECT_THAT(values(scene, "unit"), ElementsAreArray(names_of(kMeshUnits)));
}

TEST(NamesOnPages, StatesOfDevices) {
  const std::string states = section("safety.md", "## States of a device");
  EXPECT_THAT(names(states, "state | the device"),
              UnorderedElementsAreArray(names_of(kDeviceStates)));
  for (const DeviceStateRow& row : kDeviceStates) {
    EXPECT_THAT(states, testing::HasSubstr("| `" + std::string(row.name) + "` | " +
                                           std::string(row.words) + " |"));
  }
}

TEST(NamesOnPages, StagesOfLatency) {
  EXPECT_THAT(names(section("command-line.md", "## run"), "stage | from the finger to the servos"),
              ElementsAreArray(names_of(kLatencyStageNames)));
}

TEST(NamesOnPages, InstructionSets) {
  EXPECT_THAT(values(section("command-line.md", "## run"), "--simd SET"),
              ElementsAreArray(names_of(kInstructionSets)));
}

// The live page draws every shape and looks for every finger: the types of its client name them.
TEST(NamesOnPages, TypesOfTheJavaScriptClient) {
  const std::string wire = source("clients/javascript/src/messages.d.ts");
  std::vector<std::string> shapes = object_shape_names();
  shapes.emplace_back(kSoftShape);
  EXPECT_THAT(all(part(wire, "export type RigidShape =", "\n\n"), "kind: \"(\\w+)\""),
              ElementsAreArray(shapes));
  EXPECT_THAT(all(part(wire, "  hand: ", ";"), "\"(\\w+)\""),
              ElementsAreArray(names_of(kHandSides)));
  EXPECT_THAT(all(part(wire, "  finger: \"", ";"), "\"(\\w+)\""),
              ElementsAreArray(names_of(kHandFingers)));
}

}  // namespace
}  // namespace softfinger
