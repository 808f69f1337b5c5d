#pragma once

#include <vector>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/recording/record.hpp"

namespace softfinger {

/// Pressure on each sample of a recorded skin, Pa: of the force on it the part into the skin, over
/// the area around it, a third of its triangles, as deformed. Both follow from the sum A of those
/// triangles' vector areas: p = -f.A / |A|^2. NaN where the model is null or another skin's.
[[nodiscard]] std::vector<double> skin_pressures(const FingerModel* model,
                                                 const std::vector<SampleRecord>& samples);

}  // namespace softfinger
