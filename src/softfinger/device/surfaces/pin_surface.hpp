#pragma once

#include <memory>

#include "softfinger/device/contacting_surface.hpp"
#include "softfinger/device/surfaces/pin_field.hpp"

namespace softfinger {

/// Sizes of a pin array, m.
struct PinArrayGeometry {
  int rows = 0;     ///< along x
  int columns = 0;  ///< along y
  double pitch = 0.0;
  double pin_radius = 0.0;
  double stroke = 0.0;
  double pin_edge_radius = 0.0;
};

/// Pins that stand in B' and whose heights are q, rows first; 0 puts a pin's end at z = 0.
class PinSurface final : public ContactingSurface {
 public:
  PinSurface(const PinArrayGeometry& geometry, const Pose& X_FB);

  [[nodiscard]] const PinArrayGeometry& geometry() const { return geometry_; }

  /// From the end disk of the nearest pin.
  [[nodiscard]] ClosestPointResidual closest_point_residual(const Kinematics& by,
                                                            const Configuration& q,
                                                            const Vector3& p_F) const override;
  /// To the union of the pins, each a cylinder with a flat end that goes down without end.
  [[nodiscard]] SurfaceDistance signed_distance(const Kinematics& by, const Configuration& q,
                                                const Vector3& p_F) const override;
  [[nodiscard]] double deviation(const Kinematics& by, const Configuration& q,
                                 const SurfaceSamples& samples) const override;
  double deviation_derivatives(const Kinematics& by, const Configuration& q,
                               const SurfaceSamples& samples, Eigen::Ref<Eigen::VectorXd> gradient,
                               Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                               Eigen::Ref<Eigen::MatrixXd> hessian) const override;
  [[nodiscard]] double least_distance(const Kinematics& by, const Configuration& q,
                                      const SurfaceSamples& samples) const override;
  [[nodiscard]] std::shared_ptr<const ContactingSurface> mounted(const Pose& X_FB) const override {
    return std::make_shared<const PinSurface>(geometry_, X_FB);
  }
  /// B' in F: the array itself does not move.
  [[nodiscard]] Pose pose(const Kinematics& by, const Configuration& q) const override;
  [[nodiscard]] int solid_piece_count() const override { return field_.count(); }
  void solid_pieces(const Kinematics& by, const Configuration& q,
                    std::span<SolidPiece> pieces) const override;
  [[nodiscard]] const PinField* pin_field() const override { return &field_; }

 private:
  struct Nearest {
    int pin = 0;
    double distance = 0.0;  ///< m
  };
  [[nodiscard]] Nearest nearest_end(const Configuration& q, const Vector3& p_B) const;
  /// No pin (-1) and `within` itself where none is nearer than `within`.
  [[nodiscard]] Nearest nearest_pin(const Configuration& q, const Vector3& p_B,
                                    double within) const;

  PinArrayGeometry geometry_;
  PinField field_;
};

}  // namespace softfinger
