#pragma once

#include <array>

#include "softfinger/device/surfaces/pointwise_surface.hpp"

namespace softfinger {

/// Sizes of a roller, m.
struct RollerGeometry {
  double roller_radius = 0.0;
  double roller_length = 0.0;  ///< across the finger
  double roller_edge_radius = 0.0;
  double min_position = 0.0, max_position = 0.0;
  double min_height = 0.0, max_height = 0.0;
};

/// A cylinder along y of what carries it, its crest at the origin.
class RollerSurface final : public PointwiseSurface<RollerSurface> {
 public:
  explicit RollerSurface(const RollerGeometry& geometry) : geometry_(geometry) {}

  [[nodiscard]] const RollerGeometry& geometry() const { return geometry_; }

  struct Placed {
    Pose X_BF;
    RigidMotion motion;
    Vector3 middle_B;  ///< of the axis
    double radius, half_length;

    /// From the cylinder's curved side.
    [[nodiscard]] ClosestPointResidual closest_point_residual(const Vector3& p_F) const;
    /// To the cylinder with its flat ends.
    [[nodiscard]] SurfaceDistance signed_distance(const Vector3& p_F) const;

   private:
    /// A point in P from the axis' middle, and how that moves by q_k.
    [[nodiscard]] Vector3 from_axis(const Vector3& p_B) const;
    [[nodiscard]] Vector3 rate(std::size_t k, const Vector3& p_B) const;
  };
  [[nodiscard]] Placed placed(const Kinematics& by, const Configuration& q) const;

  void solid_pieces(const Kinematics& by, const Configuration& q,
                    std::span<SolidPiece> pieces) const override;

 private:
  /// Of the axis, in P.
  [[nodiscard]] Vector3 middle() const { return {0.0, 0.0, -geometry_.roller_radius}; }

  RollerGeometry geometry_;
};

}  // namespace softfinger
