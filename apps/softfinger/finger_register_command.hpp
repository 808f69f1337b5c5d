#pragma once

#include <CLI/CLI.hpp>

/// Adds `finger register` to the command `finger`.
void add_finger_register_command(CLI::App& finger);
