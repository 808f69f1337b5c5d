#pragma once

#include "softfinger/device/surfaces/pointwise_surface.hpp"

namespace softfinger {

/// A ball about the origin of what carries it, of at most three degrees of freedom.
class BallSurface final : public PointwiseSurface<BallSurface> {
 public:
  /// m.
  explicit BallSurface(double radius) : radius_(radius) {}

  struct Placed {
    double radius;
    Vector3 centre_F;
    Matrix3 rates_F;  ///< of the centre by q, by column; the last are zero where q has fewer
    int count;

    [[nodiscard]] ClosestPointResidual closest_point_residual(const Vector3& p_F) const;
    [[nodiscard]] SurfaceDistance signed_distance(const Vector3& p_F) const;
  };
  [[nodiscard]] Placed placed(const Kinematics& by, const Configuration& q) const;

  /// At the ball's highest point.
  [[nodiscard]] Pose pose(const Kinematics& by, const Configuration& q) const override;
  void solid_pieces(const Kinematics& by, const Configuration& q,
                    std::span<SolidPiece> pieces) const override;

 private:
  double radius_;
};

}  // namespace softfinger
