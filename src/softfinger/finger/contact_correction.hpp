#pragma once

#include <array>
#include <span>
#include <vector>

#include "softfinger/contact/contact_potential.hpp"
#include "softfinger/fem/stiffness_assembly.hpp"

namespace softfinger {

/// Makes a Newton direction of an old factor aware of contact as it will be. Contact changes within
/// a step far more than tissue does: samples land, leave, begin to slide. The direction d = A^-1 b
/// of the old matrix is corrected by forces of few samples, each along one line,
///
///   d = A^-1 b - sum_c alpha_c z_c,  z_c = A^-1 P_c w_c,
///
/// so that for these samples the contact force at the end of the direction is the true one of the
/// contact potential and not the one the old matrix extrapolates: a small system with no tissue in
/// it (Sherman-Morrison-Woodbury, with the contact set found on the linear model). The columns z_c
/// are kept until the next factorisation.
class ContactCorrection {
 public:
  static constexpr int kMostColumns = 96;

  /// How a point of the skin moves with the unknowns: weights of up to three blocks; none where it
  /// is tied, and such points take no part.
  struct Carrier {
    std::array<int, 3> blocks{-1, -1, -1};
    std::array<double, 3> weights{1.0, 0.0, 0.0};
    [[nodiscard]] bool is_tied() const { return blocks[0] < 0; }
  };
  /// `team`: shares the solves of columns and the sum of their responses; null: none.
  ContactCorrection(std::vector<Carrier> carriers, std::size_t unknowns, ThreadTeam* team);
  void set_carrier(std::size_t point, const Carrier& carrier) { carriers_[point] = carrier; }

  /// After a factorisation whose matrix holds `blocks[i]` for point i, and nothing for those
  /// beyond.
  void restart(std::span<const Matrix3> blocks);
  /// Whether the factored matrix, if there is one, holds something for the point.
  [[nodiscard]] bool holds(std::size_t point) const { return !held_[point].isZero(0.0); }
  /// Many columns have piled up since the last factorisation: a new one pays.
  [[nodiscard]] bool is_full() const { return count_ == most_columns_; }
  /// Before apply(): where directions start, positions of the points in W, m, and the obstacles
  /// with them.
  void start(const ContactPotential& contact, std::span<const Vector3> positions);
  /// Obstacles move too, and stand where they will be once start() has been called: `carried` is
  /// what the matrix takes contact at each point to change by with their motion, N; none is further
  /// from where it was than `way`, m. Until the next start().
  void move_obstacles(std::span<const Vector3> carried, double way);
  /// Corrects `direction`. positions: as in start(); gradient_norm: N, there; corrections much
  /// smaller are left alone.
  void apply(const ContactPotential& contact, const StiffnessAssembly& assembly,
             std::span<const Vector3> positions, double gradient_norm, std::span<double> direction);

 private:
  struct Column {
    std::size_t point = 0;
    Carrier carrier;                 ///< as it was
    Vector3 line = Vector3::Zero();  ///< w, unit
    std::vector<double> response;    ///< z
  };
  struct Deviation {
    Vector3 force = Vector3::Zero();
    Matrix3 stiffness = Matrix3::Zero();
  };
  /// What the potential says of point i after d, beyond what the matrix holds.
  [[nodiscard]] Deviation deviation(const ContactPotential& contact, std::size_t i,
                                    const Vector3& position, const Vector3& d) const;
  /// Finds the amplitudes, to `tolerance` (N).
  void balance(const ContactPotential& contact, std::span<const Vector3> positions,
               double tolerance, std::span<const double> uncorrected);
  /// Adds columns for the points that deviate most. False if there is nothing to add.
  bool add_columns(const ContactPotential& contact, const StiffnessAssembly& assembly,
                   std::span<const Vector3> positions, double threshold,
                   std::span<const double> direction);
  void correct(std::span<const double> uncorrected, std::span<double> direction) const;

  ThreadTeam* team_;
  std::vector<Carrier> carriers_;
  std::vector<Matrix3> held_;   ///< per point: second derivative in the factored matrix
  std::vector<Vector3> start_;  ///< per point: gradient where the direction starts, N; carried too
  double way_ = 0.0;            ///< of obstacles, m
  /// Fewer than kMostColumns where a factorisation is cheap.
  int most_columns_;
  std::vector<Column> columns_;
  int count_ = 0;
  std::vector<double> amplitudes_;
  std::vector<double> uncorrected_;
};

}  // namespace softfinger
