#pragma once

#include <array>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// A device that moves a flat disk: all of its surface follows from the disk's pose and how that
/// changes with q. What is left to a kind is its linkage.
class RigidDisk : public Device {
 public:
  [[nodiscard]] ClosestPointResidual closest_point_residual(const Configuration& q,
                                                            const Vector3& p_F) const override;
  [[nodiscard]] SurfaceDistance signed_distance(const Configuration& q,
                                                const Vector3& p_F) const override;
  [[nodiscard]] double deviation(const Configuration& q,
                                 const SurfaceSamples& samples) const override;
  double deviation_derivatives(const Configuration& q, const SurfaceSamples& samples,
                               Eigen::Ref<Eigen::VectorXd> gradient,
                               Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                               Eigen::Ref<Eigen::MatrixXd> hessian) const override;
  [[nodiscard]] double least_distance(const Configuration& q,
                                      const SurfaceSamples& samples) const override;
  void solid_pieces(const Configuration& q, std::span<SolidPiece> pieces) const override;
  [[nodiscard]] double disk_radius() const override { return radius_; }
  [[nodiscard]] double disk_edge_radius() const override { return edge_radius_; }

 protected:
  /// At most three degrees of freedom.
  RigidDisk(DeviceSettings settings, double radius, double edge_radius)
      : Device(std::move(settings)), radius_(radius), edge_radius_(edge_radius) {}

  /// Derivative of surface_pose(q) by q_k, in B': of the rotation's entries and of the origin.
  struct PoseRate {
    Matrix3 rotation;
    Vector3 translation;
  };
  [[nodiscard]] virtual PoseRate pose_rate(const Configuration& q, int k) const = 0;

 private:
  /// The disk at one q: a point p_P fixed in F moves in P by turn_k p_P + shift_k per q_k.
  struct Motion {
    Pose X_PF;
    std::array<Matrix3, 3> turn;
    std::array<Vector3, 3> shift;
    int count = 0;

    /// By column; the last are zero where there are fewer than three.
    [[nodiscard]] Matrix3 rates(const Vector3& p_P) const;
  };
  [[nodiscard]] Motion motion(const Configuration& q) const;
  /// Of the closest-point residual by p_P.
  [[nodiscard]] Matrix3 residual_rate(const Vector3& p_P) const;

  double radius_, edge_radius_;
};

}  // namespace softfinger
