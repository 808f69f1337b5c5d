#pragma once

#include <array>
#include <vector>

#include "softfinger/device/contacting_surface.hpp"
#include "softfinger/device/surfaces/surface_piece.hpp"

namespace softfinger {

inline constexpr std::size_t kMaxSurfacePieces = 64;

/// A surface of rigid pieces on the bodies that a kinematics moves: what is nearest of them counts.
/// All derivatives are exact where the kinematics gives its own.
class PieceSurface final : public ContactingSurface {
 public:
  /// 1 to kMaxSurfacePieces of them, on bodies below kMostBodies.
  explicit PieceSurface(std::vector<SurfacePiece> pieces);

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
  [[nodiscard]] double least_distance(const Kinematics& by, const Configuration& q,
                                      const SurfaceSamples& samples) const override;
  /// Of the first piece.
  [[nodiscard]] Pose pose(const Kinematics& by, const Configuration& q) const override;
  [[nodiscard]] int solid_piece_count() const override { return static_cast<int>(pieces_.size()); }
  void solid_pieces(const Kinematics& by, const Configuration& q,
                    std::span<SolidPiece> pieces) const override;
  /// Where a disk is the only piece.
  [[nodiscard]] double disk_radius() const override;
  [[nodiscard]] double disk_edge_radius() const override;

 private:
  struct BodySums;
  /// Where everything is at one q, in B'.
  struct Placed {
    std::array<Pose, kMostBodies> bodies;
    std::array<Pose, kMaxSurfacePieces> pieces;
  };
  [[nodiscard]] Placed placed(const Kinematics& by, const Configuration& q) const;
  [[nodiscard]] static Pose piece_pose(const Placed& placed, const SurfacePiece& piece);
  /// Which piece is nearest to a point of B', by its face or by its solid.
  [[nodiscard]] std::size_t nearest_face(const Placed& placed, const Vector3& p_B) const;
  [[nodiscard]] std::size_t nearest_solid(const Placed& placed, const Vector3& p_B) const;
  [[nodiscard]] const DiskPiece* only_disk() const;

  std::vector<SurfacePiece> pieces_;
  std::vector<double> face_reach_, solid_reach_;  ///< of each piece, m
  std::size_t bodies_ = 1;                        ///< that carry them
};

}  // namespace softfinger
