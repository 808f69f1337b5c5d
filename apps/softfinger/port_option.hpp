#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

/// An option that takes a port, from `least` (0: any free one) to 65535. Ends the program's reading
/// of its flags with a line that names the option, the value and the range.
CLI::Option* add_port_option(CLI::App& command, const std::string& name, std::uint16_t& port,
                             const std::string& what, int least = 0);
