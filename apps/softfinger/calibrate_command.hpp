#pragma once

#include <CLI/CLI.hpp>

/// `device calibrate`, below the command `device`.
void add_calibrate_action(CLI::App& device_command);
