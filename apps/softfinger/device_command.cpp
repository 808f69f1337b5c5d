#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibrate_command.hpp"
#include "commands.hpp"
#include "device_fit_command.hpp"
#include "device_json.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/device/kinds/device_kinds.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/session/report/workspace_report.hpp"

using nlohmann::ordered_json;
using namespace softfinger;

ordered_json configuration_json(const Device& device, const Configuration& q) {
  ordered_json result = ordered_json::object();
  for (std::size_t i = 0; i < device.axes().size(); ++i) {
    result[device.axes()[i].name] = q[static_cast<int>(i)] / device.axes()[i].unit();
  }
  return result;
}

void add_joints(ordered_json& answer, const Device& device, const JointAngles* joints) {
  const bool linear = device.joint_limits().linear;
  ordered_json values;  // null where the linkage does not close
  if (joints != nullptr) {
    values = ordered_json::array();
    for (const double joint : *joints) values.push_back(joint / (linear ? mm : deg));
  }
  answer["joints_deg"] = linear ? ordered_json() : values;
  if (linear) answer["joints_mm"] = values;
}

namespace {

struct DeviceFlags {
  std::string device;
  std::vector<std::string> configuration;
  std::vector<double> joints_deg, joints_mm;
  bool json = false;
};

void print_lines(const ordered_json& object, const std::string& indent = "") {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) {
      fmt::print("{}{}\n", indent, key);
      print_lines(value, indent + "  ");
    } else if (value.is_number_float()) {
      fmt::print("{}{:<28} {:.6g}\n", indent, key, value.get<double>());
    } else {
      fmt::print("{}{:<28} {}\n", indent, key, value.dump());
    }
  }
}

void answer(const ordered_json& object, bool as_json) {
  if (as_json) {
    fmt::print("{}\n", object.dump());
  } else {
    print_lines(object);
  }
}

/// q from NAME=VALUE words; axes that are not named are at home.
Configuration parse_configuration(const Device& device, const std::vector<std::string>& words) {
  Configuration q = device.home();
  std::vector<std::string> names;
  for (const auto& axis : device.axes()) names.push_back(axis.name);
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      const std::string near = nearest_word(name, names);
      throw InputError(fmt::format("device solve: --configuration {}: unknown name '{}'{}", word,
                                   name, near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
    double value = NAN;
    if (equals != std::string::npos) {
      const char* begin = word.data() + equals + 1;
      const char* end = word.data() + word.size();
      const auto [rest, failure] = std::from_chars(begin, end, value);
      if (failure != std::errc{} || rest != end) value = NAN;
    }
    if (!std::isfinite(value)) {
      throw InputError(
          fmt::format("device solve: --configuration {}: must be {}=NUMBER", word, name));
    }
    const auto axis = static_cast<std::size_t>(found - names.begin());
    q[static_cast<int>(axis)] = value * device.axes()[axis].unit();
  }
  return q;
}

void show(const DeviceFlags& flags) {
  answer(ordered_json::parse(load_device(flags.device)->settings().as_read), flags.json);
}

void solve(const DeviceFlags& flags) {
  const auto device = load_device(flags.device);
  const Configuration q = parse_configuration(*device, flags.configuration);
  JointAngles joints;
  const bool closes = device->inverse_kinematics(q, joints);
  ordered_json result{{"configuration", configuration_json(*device, q)}};
  add_joints(result, *device, closes ? &joints : nullptr);
  result["reachable"] = device->reachable(q);
  answer(result, flags.json);
}

void pose(const DeviceFlags& flags) {
  const auto device = load_device(flags.device);
  const bool linear = device->joint_limits().linear;
  const char* flag = linear ? "--joints-mm" : "--joints-deg";
  const std::vector<double>& given = linear ? flags.joints_mm : flags.joints_deg;
  if (!(linear ? flags.joints_deg : flags.joints_mm).empty()) {
    throw InputError(fmt::format("device pose: the device's joints are {}: use {}",
                                 linear ? "lengths" : "angles", flag));
  }
  if (static_cast<int>(given.size()) != device->joint_count()) {
    throw InputError(fmt::format("device pose: {}: {} values, the device has {} joints", flag,
                                 given.size(), device->joint_count()));
  }
  JointAngles joints(device->joint_count());
  for (int i = 0; i < joints.size(); ++i) {
    joints[i] = given[static_cast<std::size_t>(i)] * (linear ? mm : deg);
    if (!std::isfinite(joints[i])) {
      throw InputError(fmt::format("device pose: {}: not a finite number", flag));
    }
  }
  Configuration q;
  if (!device->forward_kinematics(joints, q)) {
    throw OperationError(
        fmt::format("device pose: no configuration inside the workspace has these joint {}",
                    linear ? "lengths" : "angles"));
  }
  answer({{"configuration", configuration_json(*device, q)}}, flags.json);
}

void workspace(const DeviceFlags& flags) {
  answer(workspace_report(load_device(flags.device)->workspace_summary()), flags.json);
}

/// The word itself where it means no file: an unknown kind, which is told with those there are.
std::string kind_of_file(const std::string& word) {
  const std::vector<std::string> shipped = shipped_names(Shipped::kDevice);
  const bool is_file =
      std::filesystem::exists(word) || std::ranges::find(shipped, word) != shipped.end();
  return is_file ? load_device(file_or_shipped(Shipped::kDevice, word))->kind() : word;
}

void schema(const DeviceFlags& flags) {
  if (!flags.device.empty()) {
    const std::vector<std::string> kinds = device_kind_names();
    const bool is_kind = std::ranges::find(kinds, flags.device) != kinds.end();
    fmt::print("{}\n", device_schema(is_kind ? flags.device : kind_of_file(flags.device)));
    return;
  }
  fmt::print("{}\n", device_schema());
}

CLI::App* add_device_action(CLI::App& command, const std::string& name, const std::string& text,
                            const std::shared_ptr<DeviceFlags>& flags,
                            void (*action)(const DeviceFlags&)) {
  CLI::App* sub = command.add_subcommand(name, text);
  takes_shipped(
      sub->add_option("DEVICE", flags->device, "Device file (TOML), or the name of a shipped one"),
      Shipped::kDevice)
      ->required();
  sub->add_flag("--json", flags->json, "One JSON object");
  sub->callback([flags, action] { action(*flags); });
  return sub;
}

}  // namespace

void add_device_command(CLI::App& app) {
  auto flags = std::make_shared<DeviceFlags>();
  CLI::App* command = app.add_subcommand("device", "What a device file describes");
  command->require_subcommand(1);
  add_device_action(*command, "show", "The file's keys, defaults filled in", flags, show);
  add_device_action(*command, "solve", "Joints of a configuration", flags, solve)
      ->add_option("--configuration", flags->configuration,
                   "NAME=VALUE,... in the units of the names; home where not given")
      ->delimiter(',');
  CLI::App* posing =
      add_device_action(*command, "pose", "Configuration of joint angles or lengths", flags, pose);
  posing->add_option("--joints-deg", flags->joints_deg, "Joint angles a,b,c")->delimiter(',');
  posing->add_option("--joints-mm", flags->joints_mm, "Lengths a,b,c of joints that are linear")
      ->delimiter(',');
  add_device_action(*command, "workspace", "How far it goes within all limits", flags, workspace);
  add_calibrate_action(*command);
  add_device_fit_action(*command);
  CLI::App* describing = command->add_subcommand("schema", "JSON Schema of the files of a kind");
  describing->add_option("KIND", flags->device, "Kind or device file; without, of all kinds");
  describing->add_flag("--json", flags->json, "Changes nothing: it is JSON as it is");
  describing->callback([flags] { schema(*flags); });
}
