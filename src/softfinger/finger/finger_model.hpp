#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "softfinger/fem/elastic_model.hpp"
#include "softfinger/finger/finger_size.hpp"
#include "softfinger/geometry/tetrahedral_mesh.hpp"

namespace softfinger {

/// Virtual coupling between the tracked and the simulated bone.
struct Coupling {
  double translation_stiffness = 1e3;  ///< N/m
  double translation_damping = 10.0;   ///< N s/m
  double rotation_stiffness = 0.2;     ///< N m/rad
  double rotation_damping = 2e-3;      ///< N m s/rad
};

/// A finger as its file describes it; immutable once built.
class FingerModel {
 public:
  /// Reads a finger file and its mesh; sizes given in `person` stand before the file's. Throws
  /// InputError with file, line and key.
  [[nodiscard]] static std::shared_ptr<const FingerModel> load(const std::filesystem::path& file,
                                                               const FingerSize& person = {});

  TetrahedralMesh mesh;                            ///< rest shape in F, m
  std::vector<int> sample_nodes;                   ///< node of each skin sample
  std::vector<double> sample_rest_areas;           ///< m^2
  std::vector<std::array<int, 3>> skin_triangles;  ///< indices into sample_nodes, outward
  std::vector<bool> node_is_rigid;                 ///< per node: moves with the bone
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
  double bone_mass = 0.01;  ///< kg
  Coupling coupling;
  double contact_tolerance = 5e-5;  ///< m
  double friction_coefficient = 0.5;
  bool feature_contact = true;  ///< between samples too, see FeaturePoints
  std::filesystem::path file;
  std::string as_read;  ///< the file as JSON, defaults filled in
};

}  // namespace softfinger
