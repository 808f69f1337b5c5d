#pragma once

#include <cstddef>
#include <functional>

namespace softfinger {

/// Told how far long work is, a fraction in [0, 1]; always on the thread that asked for the work.
using Progress = std::function<void(double)>;

/// Calls work(i) once for each i < count, on all cores; the calls must not depend on each other.
/// An exception of `work` ends the work and is thrown here.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work,
                  const Progress& progress = {});

}  // namespace softfinger
