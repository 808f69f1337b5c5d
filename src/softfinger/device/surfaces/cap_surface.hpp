#pragma once

#include <vector>

#include "softfinger/device/surfaces/pointwise_surface.hpp"

namespace softfinger {

/// Sizes of a membrane, m.
struct MembraneGeometry {
  double ring_radius = 0.0;  ///< inside radius of the ring that holds the membrane
  double rim_width = 0.0;    ///< of the ring around it
  double rim_edge_radius = 0.0;
  double min_height = 0.0;
  double max_height = 0.0;  ///< at most ring_radius: the cap is no more than half a ball
};

/// A membrane on a ring, blown up to a spherical cap of height q[0] over the ring's plane, z = 0 of
/// B'. The cap has the radius (r^2 + h^2) / (2 h) of a ball through the ring; all distances are by
/// its curvature, which goes through h = 0.
class CapSurface final : public PointwiseSurface<CapSurface> {
 public:
  explicit CapSurface(const MembraneGeometry& geometry) : geometry_(geometry) {}

  [[nodiscard]] const MembraneGeometry& geometry() const { return geometry_; }

  struct Placed {
    Pose X_BF;
    double ring_radius, height;

    /// From the nearest point of the cap.
    [[nodiscard]] ClosestPointResidual closest_point_residual(const Vector3& p_F) const;
    /// To the cap's ball above the ring's plane, and below it the ring's disk extended away from
    /// the finger as a cone with a 45-degree flank.
    [[nodiscard]] SurfaceDistance signed_distance(const Vector3& p_F) const;
  };
  [[nodiscard]] Placed placed(const Kinematics& by, const Configuration& q) const {
    return {by.mount().inverse(), geometry_.ring_radius, q[0]};
  }

  /// The ring's plane, raised to the top of the cap.
  [[nodiscard]] Pose pose(const Kinematics& by, const Configuration& q) const override;
  /// The cap's ball and the ring's plate, 2 mm thick.
  [[nodiscard]] int solid_piece_count() const override { return 2; }
  void solid_pieces(const Kinematics& by, const Configuration& q,
                    std::span<SolidPiece> pieces) const override;
  [[nodiscard]] double cap_radius() const override { return geometry_.ring_radius; }

 private:
  MembraneGeometry geometry_;
};

}  // namespace softfinger
