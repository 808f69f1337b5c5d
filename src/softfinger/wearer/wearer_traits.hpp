#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// What is not known of a wearer, one number each.
enum class WearerTrait : std::uint8_t {
  kLength,
  kBreadth,
  kDepth,
  kMountX,
  kMountY,
  kMountZ,
  kMountRoll,
  kMountPitch,
  kModulus
};

struct WearerTraitRow {
  WearerTrait value;
  std::string_view name;  ///< with the unit people read
  double unit;            ///< SI a unit of the name
  double deviation;       ///< what people vary by, standard deviation; SI, of a logarithm for sizes
};

inline constexpr int kWearerTraits = 9;
using TraitVector = Eigen::Matrix<double, kWearerTraits, 1>;
using TraitMatrix = Eigen::Matrix<double, kWearerTraits, kWearerTraits>;

/// In the order of WearerTrait. People vary in size as they do in Vergara et al., "Towards a hand
/// anthropometric database" (2017), roughly; how a thimble is put on and how stiff skin is are
/// guesses, the last a wide one: stiffness does not follow from size.
extern const std::array<WearerTraitRow, kWearerTraits> kWearerTraitRows;

/// Who wears a device, and how, as it differs from a finger file and a device file.
struct WearerTraits {
  Vector3 size_factor = Vector3::Ones();  ///< along x, y, z of F
  double modulus_factor = 1.0;
  Vector3 mount_translation = Vector3::Zero();  ///< F, m
  double mount_roll = 0.0, mount_pitch = 0.0;   ///< rad, about x and y of F

  /// Of coordinates that are 0 where nothing differs, and 1 a standard deviation from there.
  [[nodiscard]] static WearerTraits of(const TraitVector& x);
  /// See DeviceSettings::mount_fit.
  [[nodiscard]] Pose mount_fit() const;
  /// d mount_fit by coordinate: a velocity in F (m) and a spin (rad) about the mount's origin, for
  /// the columns of the mount; 0 for the others.
  [[nodiscard]] Eigen::Matrix<double, 6, kWearerTraits> mount_motion() const;
  /// The finger as it differs from this one.
  [[nodiscard]] std::shared_ptr<const FingerModel> finger(const FingerModel& model) const;
};

/// A coordinate in SI: a size of `finger` in m, a modulus as a factor.
[[nodiscard]] double trait_value(WearerTrait trait, double coordinate, const FingerModel& finger);

}  // namespace softfinger
