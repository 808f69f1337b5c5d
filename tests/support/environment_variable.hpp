#pragma once

#include <stdlib.h>

#include <optional>
#include <string>

namespace softfinger {

/// A variable of the environment with another value until the end of the scope; empty: without it.
/// Not beside threads that read the environment.
class EnvironmentVariable {
 public:
  EnvironmentVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = ::getenv(name)) before_ = before;
    put(value.empty() ? std::nullopt : std::optional(value));
  }
  ~EnvironmentVariable() { put(before_); }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

 private:
  void put(const std::optional<std::string>& value) const {
    value ? ::setenv(name_, value->c_str(), 1) : ::unsetenv(name_);
  }

  const char* name_;
  std::optional<std::string> before_;
};

}  // namespace softfinger
