#pragma once

#include <CLI/CLI.hpp>

/// Adds `finger fit` to the command `finger`.
void add_finger_fit_command(CLI::App& finger);
