#pragma once

#include "softfinger/device/surfaces/disk_surface.hpp"

namespace softfinger {

/// A disk with exact second derivatives, for a kinematics that gives its own (RigidMotion::exact).
class ExactDisk final : public DiskSurface {
 public:
  using DiskSurface::DiskSurface;

  [[nodiscard]] ClosestPointResidual closest_point_residual(const Kinematics& by,
                                                            const Configuration& q,
                                                            const Vector3& p_F) const override;
  [[nodiscard]] SurfaceDistance signed_distance(const Kinematics& by, const Configuration& q,
                                                const Vector3& p_F) const override;
  [[nodiscard]] double deviation(const Kinematics& by, const Configuration& q,
                                 const SurfaceSamples& samples) const override;
  double deviation_derivatives(const Kinematics& by, const Configuration& q,
                               const SurfaceSamples& samples, Eigen::Ref<Eigen::VectorXd> gradient,
                               Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                               Eigen::Ref<Eigen::MatrixXd> hessian) const override;
};

}  // namespace softfinger
