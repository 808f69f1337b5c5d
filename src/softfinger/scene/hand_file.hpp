#pragma once

#include <vector>

#include "softfinger/files/config_file.hpp"
#include "softfinger/scene/scene.hpp"

namespace softfinger {

/// A `[[hand]]` of a scene file as its table says.
struct ReadHand {
  ConfigTable table;
  SceneHand hand;
  double size = 1.0;
  double force_limit = 0.0;  ///< N, of each of its bones
  std::optional<double> friction_coefficient;
};

/// Throws InputError with file, line and key, as the others do.
[[nodiscard]] std::vector<ReadHand> read_hands(const std::vector<ConfigTable>& tables);

/// What the finger's table says of the hand that it belongs to, where it does: key `hand`.
void read_hand_of(const ConfigTable& table, const std::vector<ReadHand>& hands,
                  SceneFinger& finger);

/// Adds the bones of every hand to the scene's objects.
void add_hands(const std::vector<ReadHand>& read, Scene& scene);

}  // namespace softfinger
