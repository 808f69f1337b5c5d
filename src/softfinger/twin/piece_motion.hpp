#pragma once

#include <span>
#include <vector>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// How one rigid piece of a device's solid moves as one coordinate of q does, in F.
struct PieceMotion {
  Vector3 origin = Vector3::Zero();    ///< of the piece's frame, m
  Vector3 velocity = Vector3::Zero();  ///< of the origin, m by rad or m
  Vector3 spin = Vector3::Zero();      ///< rad by rad or m
  double growth = 0.0;                 ///< of a ball's radius, m by rad or m

  /// Velocity of the surface at p_F where its outward normal is `outward`.
  [[nodiscard]] Vector3 at(const Vector3& p_F, const Vector3& outward) const {
    return velocity + spin.cross(p_F - origin) + growth * outward;
  }
  [[nodiscard]] bool moves() const {
    return growth != 0.0 || !velocity.isZero(0.0) || !spin.isZero(0.0);
  }
};

/// Motions of all pieces by all coordinates, from central differences of their poses, which are
/// smooth. Allocates only in the constructor.
class PieceMotions {
 public:
  explicit PieceMotions(const Device& device);

  void at(const Configuration& q);
  /// How far the piece that moves farthest goes from one configuration to another, m, in the metric
  /// of the axes that move it.
  [[nodiscard]] double longest(const Configuration& from, const Configuration& to) const;
  /// Of piece `piece` by coordinate `k`.
  [[nodiscard]] const PieceMotion& operator()(std::size_t piece, int k) const {
    return motions_[place(piece, k)];
  }

 private:
  [[nodiscard]] std::size_t place(std::size_t piece, int k) const {
    return piece * static_cast<std::size_t>(device_.degrees_of_freedom()) +
           static_cast<std::size_t>(k);
  }

  const Device& device_;
  std::vector<SolidPiece> forward_, backward_;
  std::vector<PieceMotion> motions_;
  std::vector<char> moves_;  ///< whether coordinate k moves the piece, as motions_; at home
};

}  // namespace softfinger
