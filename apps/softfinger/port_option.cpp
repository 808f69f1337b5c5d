#include "port_option.hpp"

#include <fmt/core.h>

#include "softfinger/base/error.hpp"

CLI::Option* add_port_option(CLI::App& command, const std::string& name, std::uint16_t& port,
                             const std::string& what, int least) {
  static constexpr int kMost = 65535;
  const auto take = [&port, name, least](const std::string& text) {
    int number = 0;
    const bool whole = !text.empty() && text.size() <= 5 &&
                       text.find_first_not_of("0123456789") == std::string::npos;
    if (whole) number = std::stoi(text);
    if (!whole || number < least || number > kMost) {
      throw softfinger::InputError(
          fmt::format("{} {}: must be a whole number of {} to {}", name, text, least, kMost));
    }
    port = static_cast<std::uint16_t>(number);
  };
  CLI::Option* option = command.add_option_function<std::string>(name, take, what);
  option->type_name("UINT")->default_str(std::to_string(port));
  return option;
}
