#pragma once

#include "softfinger/device/linear_drives.hpp"

namespace softfinger {

/// Sizes of a membrane, m.
struct MembraneGeometry {
  double ring_radius = 0.0;  ///< inside radius of the ring that holds the membrane
  double rim_width = 0.0;    ///< of the ring around it
  double rim_edge_radius = 0.0;
  double min_height = 0.0;
  double max_height = 0.0;  ///< at most ring_radius: the cap is no more than half a ball
};

/// A membrane on a ring, blown up to a spherical cap: q = the cap's height over the ring's plane,
/// z = 0 of B'. After the softness displays with a membrane under the pad, e.g. Frediani, Carpi,
/// "Tactile display of softness on fingertip", Scientific Reports 10, 2020. The cap has the radius
/// (r^2 + h^2) / (2 h) of a ball through the ring; all distances are by its curvature, which goes
/// through h = 0.
class Membrane final : public LinearDrives {
 public:
  /// The settings come with the axes and joint limits of the kind.
  Membrane(DeviceSettings settings, const MembraneGeometry& geometry);

  [[nodiscard]] static std::vector<ConfigurationAxis> axes_for(const MembraneGeometry& geometry);
  [[nodiscard]] const MembraneGeometry& geometry() const { return geometry_; }

  /// From the nearest point of the cap.
  [[nodiscard]] ClosestPointResidual closest_point_residual(const Configuration& q,
                                                            const Vector3& p_F) const override;
  /// To the cap's ball above the ring's plane, and below it the ring's disk extended away from the
  /// finger as a cone with a 45-degree flank.
  [[nodiscard]] SurfaceDistance signed_distance(const Configuration& q,
                                                const Vector3& p_F) const override;

  [[nodiscard]] int approach_axis() const override { return 0; }
  /// The ring's plane, raised to the top of the cap.
  [[nodiscard]] Pose surface_pose(const Configuration& q) const override;
  /// The cap's ball and the ring's plate, 2 mm thick.
  [[nodiscard]] int solid_piece_count() const override { return 2; }
  void solid_pieces(const Configuration& q, std::span<SolidPiece> pieces) const override;
  [[nodiscard]] double cap_radius() const override { return geometry_.ring_radius; }

 private:
  MembraneGeometry geometry_;
  Pose X_BF_;
};

}  // namespace softfinger
