#include "guard_option.hpp"

#include "softfinger/actuation/guard_program.hpp"
#include "softfinger/base/error.hpp"

std::filesystem::path guard_program() {
  const std::filesystem::path guard = softfinger::find_guard_program();
  if (guard.empty()) {
    throw softfinger::OperationError(
        "softfinger-guard: is not there; it belongs beside softfinger and owns the ports of "
        "devices");
  }
  return guard;
}
