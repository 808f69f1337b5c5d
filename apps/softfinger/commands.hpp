#pragma once

#include <CLI/CLI.hpp>

// One function a command, each in <name>_command.cpp: adds the subcommand with its flags, help and
// a callback that does the work. A callback throws InputError (status 2) or OperationError (status
// 1), or CLI::RuntimeError(status) to end with a status after it has spoken.
void add_complete_command(CLI::App& app);
void add_condition_command(CLI::App& app);
void add_device_command(CLI::App& app);
void add_emulate_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_finger_command(CLI::App& app);
void add_help_command(CLI::App& app);
void add_manual_command(CLI::App& app);
void add_match_command(CLI::App& app);
void add_press_command(CLI::App& app);
void add_replay_command(CLI::App& app);
void add_run_command(CLI::App& app);
void add_scene_command(CLI::App& app);
void add_study_command(CLI::App& app);
