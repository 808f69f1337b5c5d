#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "softfinger/finger/finger_size.hpp"
#include "softfinger/finger/soft_solid.hpp"

namespace softfinger {

/// Virtual coupling between the tracked and the simulated bone.
struct Coupling {
  double translation_stiffness = 1e3;  ///< N/m
  double translation_damping = 10.0;   ///< N s/m
  double rotation_stiffness = 0.2;     ///< N m/rad
  double rotation_damping = 2e-3;      ///< N m s/rad
};

/// A finger as its file describes it; immutable once built.
class FingerModel : public SoftSolid {
 public:
  FingerModel() = default;
  /// A soft object, to be stepped as a finger whose bone is where it is put.
  explicit FingerModel(const SoftSolid& solid) : SoftSolid(solid) {}

  /// Reads a finger file and its mesh; sizes given in `person` stand before the file's, and Young's
  /// moduli and the stiffness of strain limits are `modulus_factor` times the file's, so that force
  /// is. Throws InputError with file, line and key.
  [[nodiscard]] static std::shared_ptr<const FingerModel> load(const std::filesystem::path& file,
                                                               const FingerSize& person = {},
                                                               double modulus_factor = 1.0);
  /// The same of a file's text at hand, which may differ from the file.
  [[nodiscard]] static std::shared_ptr<const FingerModel> load(const std::filesystem::path& file,
                                                               const std::string& text,
                                                               const FingerSize& person = {},
                                                               double modulus_factor = 1.0);

  double bone_mass = 0.01;  ///< kg
  Coupling coupling;
  double friction_coefficient = 0.5;
  std::string as_read;  ///< the file as JSON, defaults filled in
};

}  // namespace softfinger
