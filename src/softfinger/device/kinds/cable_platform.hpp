#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "softfinger/device/kinematics.hpp"

namespace softfinger {

/// Sizes of a platform on three cables, m, N/m, N m/rad and rad.
struct CablePlatformGeometry {
  double base_radius = 0.0;      ///< where the cables leave the base
  double platform_radius = 0.0;  ///< where they are tied to the platform
  double neutral_height = 0.0;   ///< base plane above the neutral platform
  double winch_radius = 0.0;
  double spring_length = 0.0;     ///< free; more than neutral_height
  double spring_stiffness = 0.0;  ///< along z
  double spring_bending = 0.0;    ///< against tilt
  double least_tension = 0.0;     ///< N, of a cable that counts as taut
  double disk_radius = 0.0;
  double disk_edge_radius = 0.0;
  double max_tilt = 0.0;
};

/// Three cables at azimuth 0, 120, 240 degrees pull a disk towards a base on the nail side, against
/// a spring between their centres that pushes it away: q = (pitch, roll, travel), orientation and
/// frame B' as for the 3-RRS but with the centre on the z axis, where the spring holds it. After
/// Prattichizzo, Chinello, Pacchierotti, Malvezzi, "Towards wearability in fingertip haptics: a
/// 3-DoF wearable device for cutaneous force feedback", IEEE Trans. Haptics 6, 2013. Joints: winch
/// angles, 0 at q = 0, growing as a cable is wound up.
///
/// Cables only pull. With lengths l(q) and the spring's energy V(q), the tensions t that hold the
/// platform still solve sum_i t_i dl_i/dq = -dV/dq; the workspace is where all are at least the
/// least tension, winches and tilt are within their limits.
class CablePlatform final : public Kinematics {
 public:
  /// The settings come with the axes of the kind.
  CablePlatform(const DeviceSettings& settings, const CablePlatformGeometry& geometry);

  [[nodiscard]] static std::vector<ConfigurationAxis> axes_for(
      const CablePlatformGeometry& geometry);
  [[nodiscard]] const CablePlatformGeometry& geometry() const { return geometry_; }

  [[nodiscard]] bool inverse_kinematics(const Configuration& q, JointAngles& joints) const override;
  [[nodiscard]] bool forward_kinematics(const JointAngles& joints, Configuration& q) const override;
  [[nodiscard]] bool reachable(const Configuration& q) const override;
  /// Cable tensions that balance the spring, N; false where no tensions do.
  [[nodiscard]] bool tensions(const Configuration& q, Vector3& tension) const;

  [[nodiscard]] int constraint_count() const override { return kConstraints; }
  [[nodiscard]] bool constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                 Eigen::Ref<Eigen::MatrixXd> jacobian) const override;
  /// Of winches and tilt; tensions are taken as straight.
  void add_constraint_curvature(const Configuration& q,
                                const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                Eigen::Ref<Eigen::MatrixXd> hessian) const override;
  [[nodiscard]] std::span<const std::string> constraint_names(int k) const override;

  [[nodiscard]] Configuration facing(const Vector3& normal_F,
                                     const Configuration& q) const override;
  [[nodiscard]] int approach_axis() const override { return 2; }
  [[nodiscard]] Pose pose(const Configuration& q) const override;
  [[nodiscard]] RigidMotion motion(const Configuration& q) const override;
  [[nodiscard]] int leg_count() const override { return 3; }
  /// A cable has no knee: its middle stands for it.
  void linkage(const Configuration& q, std::span<Vector3> points_F) const override;

 private:
  [[nodiscard]] std::unique_ptr<Kinematics> copy() const override {
    return std::make_unique<CablePlatform>(*this);
  }
  // Joints above max, joints below min, cables too slack, each for 1 to 3; tilt.
  static constexpr int kConstraints = 10;

  /// Length of one cable with its derivatives by q.
  struct Cable {
    double length = 0.0;
    Vector3 rate;
    Matrix3 bend;
  };
  [[nodiscard]] std::array<Cable, 3> cables(const Configuration& q) const;
  [[nodiscard]] std::optional<PlatformSpace> platform_space() const override;
  [[nodiscard]] bool newton_forward(const JointAngles& joints, Configuration& q) const;
  /// dV/dq of the spring.
  [[nodiscard]] Vector3 spring_force(const Configuration& q) const;

  CablePlatformGeometry geometry_;
  double neutral_length_ = 0.0;  ///< of the cables at q = 0, m
  std::array<std::vector<std::string>, kConstraints> names_;
};

}  // namespace softfinger
