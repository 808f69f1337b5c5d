#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/fem/elastic_model.hpp"
#include "softfinger/geometry/tetrahedral_mesh.hpp"

namespace softfinger {

/// Soft tissue with a surface that touches: what a finger has about its bone, and what a soft
/// object is. At rest, in its frame, m.
class SoftSolid {
 public:
  // Physical surfaces of a soft object's mesh.
  static constexpr std::string_view kTouchingGroup = "surface";
  static constexpr std::string_view kHeldGroup = "fixed";

  TetrahedralMesh mesh;
  std::vector<int> sample_nodes;                   ///< node of each sample of the surface
  std::vector<double> sample_rest_areas;           ///< m^2
  std::vector<std::array<int, 3>> skin_triangles;  ///< indices into sample_nodes, outward
  std::vector<bool> node_is_rigid;                 ///< per node: moves with the frame (the bone)
  std::vector<int> tetrahedron_material;  ///< per tetrahedron, index into materials; -1: rigid
  struct Material : ElasticMaterial {
    std::string volume;  ///< of the mesh
    double share = 0.0;  ///< of all soft tissue, by volume at rest
  };
  std::vector<Material> materials;
  /// E / (1 - nu^2), the mean of all soft tissue, Pa.
  [[nodiscard]] double plane_modulus() const;
  Dilatation dilatation = Dilatation::kElement;
  Relaxation relaxation;
  StrainLimit strain_limits;
  double contact_tolerance = 5e-5;  ///< m
  std::filesystem::path file;       ///< it was read from
  bool feature_contact = true;      ///< between samples too, see FeaturePoints

  /// Limits for what has none of its own: foam crushed to a third grows stiff, as its cells' walls
  /// meet (Gibson and Ashby, "Cellular Solids", 1997), and does not turn inside out under whatever
  /// falls on it. As stiff as its softest material; there is no limit to stretching.
  [[nodiscard]] StrainLimit densification() const;
  /// Whether some of it is held by its frame.
  [[nodiscard]] bool is_held() const;
  [[nodiscard]] double mass() const;  ///< kg
  /// Fills in areas of samples and shares of materials, when all else is there.
  void measure();
};

}  // namespace softfinger
