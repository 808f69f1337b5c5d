#pragma once

#include <CLI/CLI.hpp>

/// Adds `device fit` to the command `device`.
void add_device_fit_action(CLI::App& device);
