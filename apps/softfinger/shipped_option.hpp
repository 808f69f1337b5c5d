#pragma once

#include <CLI/CLI.hpp>

#include "softfinger/files/shipped_file.hpp"

/// What an option that takes a file of this kind calls its value.
constexpr const char* value_name(softfinger::Shipped kind) {
  return kind == softfinger::Shipped::kScene    ? "SCENE"
         : kind == softfinger::Shipped::kDevice ? "DEVICE"
         : kind == softfinger::Shipped::kStudy  ? "STUDY"
                                                : "FINGER";
}

/// The option takes a file, or the name of a shipped one, and has the path of either.
inline CLI::Option* takes_shipped(CLI::Option* option, softfinger::Shipped kind) {
  if (!option->get_positional()) option->type_name(value_name(kind));
  return option->transform(
      [kind](const std::string& word) { return softfinger::file_or_shipped(kind, word).string(); },
      "");
}
