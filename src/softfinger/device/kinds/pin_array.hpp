#pragma once

#include <string>

#include "softfinger/device/linear_drives.hpp"
#include "softfinger/device/pin_field.hpp"

namespace softfinger {

inline constexpr int kMaxPinRows = 16;  ///< and columns: squared, the most degrees of freedom

/// Sizes of a pin array, m.
struct PinArrayGeometry {
  int rows = 0;     ///< along x
  int columns = 0;  ///< along y
  double pitch = 0.0;
  double pin_radius = 0.0;
  double stroke = 0.0;
  double pin_edge_radius = 0.0;
};

/// Pins that rise towards the finger one by one: q = their heights, rows first; 0 puts a pin's end
/// at z = 0 of B', the stroke is the most. After Wagner, Lederman, Howe, "A tactile shape display
/// using RC servomotors", Haptics Symposium 2002.
class PinArray final : public LinearDrives {
 public:
  /// The settings come with the axes and joint limits of the kind.
  PinArray(DeviceSettings settings, const PinArrayGeometry& geometry);

  [[nodiscard]] static std::vector<ConfigurationAxis> axes_for(const PinArrayGeometry& geometry);
  [[nodiscard]] const PinArrayGeometry& geometry() const { return geometry_; }

  /// From the end disk of the nearest pin.
  [[nodiscard]] ClosestPointResidual closest_point_residual(const Configuration& q,
                                                            const Vector3& p_F) const override;
  /// To the union of the pins, each a cylinder with a flat end that goes down without end.
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

  [[nodiscard]] int approach_axis() const override { return -1; }
  [[nodiscard]] bool advances() const override { return true; }
  /// All pins together.
  void advance(double distance, Configuration& q) const override;

  /// B' in F: the array itself does not move.
  [[nodiscard]] Pose surface_pose(const Configuration& q) const override;
  [[nodiscard]] int solid_piece_count() const override { return degrees_of_freedom(); }
  void solid_pieces(const Configuration& q, std::span<SolidPiece> pieces) const override;
  [[nodiscard]] const PinField* pin_field() const override { return &field_; }
  [[nodiscard]] WorkspaceSummary workspace_summary() const override;

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
