#include "softfinger/wearer/wearer_traits.hpp"

#include <cmath>

#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_size.hpp"

namespace softfinger {

const std::array<WearerTraitRow, kWearerTraits> kWearerTraitRows{{
    {WearerTrait::kLength, "length_mm", mm, 0.06},
    {WearerTrait::kBreadth, "breadth_mm", mm, 0.07},
    {WearerTrait::kDepth, "depth_mm", mm, 0.08},
    {WearerTrait::kMountX, "mount_x_mm", mm, 1.5 * mm},
    {WearerTrait::kMountY, "mount_y_mm", mm, 1.0 * mm},
    {WearerTrait::kMountZ, "mount_z_mm", mm, 1.0 * mm},
    {WearerTrait::kMountRoll, "mount_roll_deg", deg, 4.0 * deg},
    {WearerTrait::kMountPitch, "mount_pitch_deg", deg, 4.0 * deg},
    {WearerTrait::kModulus, "modulus_factor", 1.0, 0.3},
}};

namespace {

double deviation(WearerTrait trait) {
  return kWearerTraitRows[static_cast<std::size_t>(trait)].deviation;
}

double scaled(const TraitVector& x, WearerTrait trait) {
  return x[static_cast<Eigen::Index>(trait)] * deviation(trait);
}

}  // namespace

WearerTraits WearerTraits::of(const TraitVector& x) {
  const auto at = [&](WearerTrait trait) { return scaled(x, trait); };
  return {.size_factor = {std::exp(at(WearerTrait::kLength)), std::exp(at(WearerTrait::kBreadth)),
                          std::exp(at(WearerTrait::kDepth))},
          .modulus_factor = std::exp(at(WearerTrait::kModulus)),
          .mount_translation = {at(WearerTrait::kMountX), at(WearerTrait::kMountY),
                                at(WearerTrait::kMountZ)},
          .mount_roll = at(WearerTrait::kMountRoll),
          .mount_pitch = at(WearerTrait::kMountPitch)};
}

Pose WearerTraits::mount_fit() const {
  return {exp_rotation({mount_roll, mount_pitch, 0.0}), mount_translation};
}

Eigen::Matrix<double, 6, kWearerTraits> WearerTraits::mount_motion() const {
  Eigen::Matrix<double, 6, kWearerTraits> motion;
  motion.setZero();
  const auto column = [](WearerTrait trait) { return static_cast<Eigen::Index>(trait); };
  motion(0, column(WearerTrait::kMountX)) = deviation(WearerTrait::kMountX);
  motion(1, column(WearerTrait::kMountY)) = deviation(WearerTrait::kMountY);
  motion(2, column(WearerTrait::kMountZ)) = deviation(WearerTrait::kMountZ);
  // The left Jacobian of the rotation vector.
  const Matrix3 r = skew({mount_roll, mount_pitch, 0.0});
  const double angle = std::hypot(mount_roll, mount_pitch);
  Matrix3 spin = Matrix3::Identity() + 0.5 * r;
  if (angle > 1e-6) {
    const double square = angle * angle;
    spin = Matrix3::Identity() + (1.0 - std::cos(angle)) / square * r +
           (angle - std::sin(angle)) / (square * angle) * r * r;
  }
  motion.block<3, 1>(3, column(WearerTrait::kMountRoll)) =
      deviation(WearerTrait::kMountRoll) * spin.col(0);
  motion.block<3, 1>(3, column(WearerTrait::kMountPitch)) =
      deviation(WearerTrait::kMountPitch) * spin.col(1);
  return motion;
}

std::shared_ptr<const FingerModel> WearerTraits::finger(const FingerModel& model) const {
  auto finger = std::make_shared<FingerModel>(model);
  for (Vector3& node : finger->mesh.nodes) node = node.cwiseProduct(size_factor);
  finger->measure();
  for (FingerModel::Material& material : finger->materials) {
    material.youngs_modulus *= modulus_factor;
  }
  finger->strain_limits.stiffness *= modulus_factor;
  return finger;
}

double trait_value(WearerTrait trait, double coordinate, const FingerModel& finger) {
  const double x = coordinate * deviation(trait);
  const FingerSize size = finger_size(finger);
  switch (trait) {
    case WearerTrait::kLength:
      return *size.length * std::exp(x);
    case WearerTrait::kBreadth:
      return *size.breadth * std::exp(x);
    case WearerTrait::kDepth:
      return *size.depth * std::exp(x);
    case WearerTrait::kModulus:
      return std::exp(x);
    default:
      return x;
  }
}

}  // namespace softfinger
