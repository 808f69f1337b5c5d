#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "softfinger/geometry/pose.hpp"

namespace softfinger::relations {

/// How many cases a relation is tried on: `usual` times SOFTFINGER_RELATIONS_SIZE (1 where unset),
/// at least one.
[[nodiscard]] int cases(int usual);

/// Numbers drawn for one case of one relation. They depend on SOFTFINGER_RELATIONS_SEED (1 where
/// unset), the relation's name and the case's number alone, on every machine alike.
class Draw {
 public:
  Draw(std::string_view relation, int number);

  [[nodiscard]] double between(double least, double most);
  /// A whole number from 0 to count - 1.
  [[nodiscard]] int below(int count);
  [[nodiscard]] bool chance(double probability) { return between(0.0, 1.0) < probability; }
  /// Evenly over all directions.
  [[nodiscard]] Vector3 direction();
  /// Anywhere, turned any way, within `reach` (m).
  [[nodiscard]] Pose pose(double reach);

 private:
  std::uint64_t next();
  std::uint64_t state_;
};

}  // namespace softfinger::relations
