#pragma once

#include <memory>
#include <span>
#include <vector>

#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// Strain energy density of every soft element of a finger: corotated linear with the strain limits
/// (see ElasticModel, StrainLimit), of the instantaneous moduli. Element by element from a singular
/// value decomposition: for judging states, not for stepping.
class StrainEnergy {
 public:
  explicit StrainEnergy(std::shared_ptr<const FingerModel> model);

  /// Soft elements, in the order of the mesh; those whose nodes are all rigid are left out.
  [[nodiscard]] std::size_t elements() const { return elements_.size(); }
  /// Rest volume of each, m^3.
  [[nodiscard]] std::span<const double> volumes() const { return volumes_; }
  /// Of the skin with its nodes at `positions` (all nodes, m, any frame), J/m^3, per element.
  void densities(std::span<const Vector3> positions, std::span<double> densities) const;

 private:
  struct Element {
    std::array<int, 4> nodes;
    int material;
    int patch;  ///< -1: keeps its own volume
    Matrix3 rest_inverse;
  };

  std::shared_ptr<const FingerModel> model_;
  std::vector<Element> elements_;
  std::vector<double> volumes_;
  std::vector<double> patch_volumes_;
};

}  // namespace softfinger
