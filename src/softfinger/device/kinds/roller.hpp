#pragma once

#include "softfinger/device/linear_drives.hpp"

namespace softfinger {

/// Sizes of a roller, m.
struct RollerGeometry {
  double roller_radius = 0.0;
  double roller_length = 0.0;  ///< across the finger
  double roller_edge_radius = 0.0;
  double min_position = 0.0, max_position = 0.0;
  double min_height = 0.0, max_height = 0.0;
};

/// A cylinder across the finger (along y of B') that moves along it: q = (position along x, height
/// of its crest over z = 0). After the contact location display of Provancher, Cutkosky,
/// Kuchenbecker, Niemeyer, "Contact location display for haptic perception of curvature and object
/// motion", Int. J. Robotics Research 24, 2005.
class Roller final : public LinearDrives {
 public:
  /// The settings come with the axes and joint limits of the kind.
  Roller(DeviceSettings settings, const RollerGeometry& geometry);

  [[nodiscard]] static std::vector<ConfigurationAxis> axes_for(const RollerGeometry& geometry);
  [[nodiscard]] const RollerGeometry& geometry() const { return geometry_; }

  /// From the cylinder's curved side.
  [[nodiscard]] ClosestPointResidual closest_point_residual(const Configuration& q,
                                                            const Vector3& p_F) const override;
  /// To the cylinder with its flat ends.
  [[nodiscard]] SurfaceDistance signed_distance(const Configuration& q,
                                                const Vector3& p_F) const override;

  [[nodiscard]] int approach_axis() const override { return 1; }
  /// At the crest.
  [[nodiscard]] Pose surface_pose(const Configuration& q) const override;
  void solid_pieces(const Configuration& q, std::span<SolidPiece> pieces) const override;

 private:
  /// From the axis to a point, in B'.
  [[nodiscard]] Vector3 from_axis(const Configuration& q, const Vector3& p_F) const;

  RollerGeometry geometry_;
  Pose X_BF_;
};

}  // namespace softfinger
