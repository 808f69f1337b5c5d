#include "softfinger/finger/contact_correction.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

/// A point is looked at where its gap is less than it moves and this, m.
constexpr double kReach = 1e-4;
/// Deviations below this part of the gradient can wait for the next iteration.
constexpr double kWorthwhile = 0.02;
constexpr int kRounds = 4;
constexpr int kMostARound = ContactCorrection::kMostColumns / kRounds;
/// A column costs a solve, which grows slower with the mesh than the factorisation it saves.
constexpr int kUnknownsAColumn = 24;
constexpr int kLeastColumns = 16;
/// Part of the gradient that the small system may leave.
constexpr double kBalanceAccuracy = 1e-5;
constexpr int kBalanceIterations = 20;
constexpr int kBalanceHalvings = 4;
/// Parts of a correction that threads share.
constexpr std::size_t kSlices = 4;
constexpr std::size_t kTermsWorthSharing = 100000;

Vector3 moved(const ContactCorrection::Carrier& carrier, std::span<const double> direction) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t k = 0; k < 3 && carrier.blocks[k] >= 0; ++k) {
    const auto at = static_cast<std::size_t>(3 * carrier.blocks[k]);
    sum += carrier.weights[k] * Vector3(direction[at], direction[at + 1], direction[at + 2]);
  }
  return sum;
}

}  // namespace

ContactCorrection::ContactCorrection(std::vector<Carrier> carriers, std::size_t unknowns,
                                     ThreadTeam* team)
    : team_(team),
      carriers_(std::move(carriers)),
      held_(carriers_.size(), Matrix3::Zero()),
      start_(carriers_.size(), Vector3::Zero()),
      most_columns_(
          std::clamp(static_cast<int>(unknowns) / kUnknownsAColumn, kLeastColumns, kMostColumns)),
      columns_(static_cast<std::size_t>(most_columns_)),
      amplitudes_(columns_.size(), 0.0),
      uncorrected_(unknowns, 0.0) {
  for (Column& column : columns_) column.response.assign(unknowns, 0.0);
}

void ContactCorrection::restart(std::span<const Matrix3> blocks) {
  std::copy(blocks.begin(), blocks.end(), held_.begin());
  std::fill(held_.begin() + static_cast<std::ptrdiff_t>(blocks.size()), held_.end(),
            Matrix3::Zero());
  count_ = 0;
}

ContactCorrection::Deviation ContactCorrection::deviation(const ContactPotential& contact,
                                                          std::size_t i, const Vector3& position,
                                                          const Vector3& d) const {
  // The old matrix takes the gradient to change by what it holds times the motion.
  const ContactPotential::Response after = contact.respond(i, position + d);
  return {after.gradient - start_[i] - held_[i] * d, after.hessian - held_[i]};
}

bool ContactCorrection::add_columns(const ContactPotential& contact,
                                    const StiffnessAssembly& assembly,
                                    std::span<const Vector3> positions, double threshold,
                                    std::span<const double> direction) {
  struct Candidate {
    double force = 0.0;
    std::size_t point = 0;
    Vector3 line = Vector3::Zero();
  };
  std::array<Candidate, kMostARound> found{};
  const std::span<Candidate> greatest(found.data(),
                                      static_cast<std::size_t>(most_columns_ / kRounds));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (carriers_[i].is_tied()) continue;
    const Vector3 d = moved(carriers_[i], direction);
    if (contact.gap(i) > d.norm() + way_ + kReach && !holds(i)) continue;
    Vector3 force = deviation(contact, i, positions[i], d).force;
    // Along lines that the point has already, balance() has seen to it.
    for (int c = 0; c < count_; ++c) {
      const Column& column = columns_[static_cast<std::size_t>(c)];
      if (column.point == i) force -= column.line * column.line.dot(force);
    }
    Candidate candidate{force.norm(), i, force};
    if (candidate.force <= threshold) continue;
    // Kept in falling order, equals in the order of points: the same columns on every run.
    for (Candidate& g : greatest) {
      if (candidate.force > g.force) std::swap(candidate, g);
    }
  }
  std::array<std::span<double>, kMostARound> responses;
  std::size_t added = 0;
  for (const Candidate& g : greatest) {
    if (!(g.force > 0.0) || count_ == most_columns_) break;
    Column& column = columns_[static_cast<std::size_t>(count_)];
    column.point = g.point;
    column.carrier = carriers_[g.point];
    column.line = g.line / g.force;
    std::fill(column.response.begin(), column.response.end(), 0.0);
    for (std::size_t k = 0; k < 3 && column.carrier.blocks[k] >= 0; ++k) {
      const auto at = static_cast<std::size_t>(3 * column.carrier.blocks[k]);
      for (std::size_t c = 0; c < 3; ++c) {
        column.response[at + c] = column.carrier.weights[k] * column.line[static_cast<int>(c)];
      }
    }
    responses[added++] = column.response;
    amplitudes_[static_cast<std::size_t>(count_)] = 0.0;
    ++count_;
  }
  assembly.solve_together({responses.data(), added}, team_);
  return added > 0;
}

void ContactCorrection::balance(const ContactPotential& contact, std::span<const Vector3> positions,
                                double tolerance, std::span<const double> uncorrected) {
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostColumns, kMostColumns>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostColumns, 1>;
  using Moves = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostColumns>;
  // The unknowns are the amplitudes alone: all that the tissue does is in the columns' responses.
  std::array<Moves, kMostColumns> moves;  // of column c's point, by each amplitude
  std::array<Vector3, kMostColumns> start;
  for (int c = 0; c < count_; ++c) {
    const auto cu = static_cast<std::size_t>(c);
    start[cu] = moved(columns_[cu].carrier, uncorrected);
    moves[cu].resize(3, count_);
    for (int k = 0; k < count_; ++k) {
      moves[cu].col(k) =
          moved(columns_[cu].carrier, columns_[static_cast<std::size_t>(k)].response);
    }
  }
  Matrix jacobian(count_, count_);
  Vector amplitudes = Vector::Zero(count_);
  Vector excess(count_);
  // Amplitude c is to be the deviation along line c where all columns together put its point.
  const auto evaluate = [&] {
    for (int c = 0; c < count_; ++c) {
      const auto cu = static_cast<std::size_t>(c);
      const Column& column = columns_[cu];
      const Deviation beyond = deviation(contact, column.point, positions[column.point],
                                         start[cu] - moves[cu] * amplitudes);
      excess[c] = amplitudes[c] - column.line.dot(beyond.force);
      jacobian.row(c) = (beyond.stiffness.transpose() * column.line).transpose() * moves[cu];
      jacobian(c, c) += 1.0;
    }
    return excess.norm();
  };
  double norm = evaluate();
  for (int iteration = 0; iteration < kBalanceIterations && norm > tolerance; ++iteration) {
    const Vector step = jacobian.partialPivLu().solve(excess);
    if (!step.allFinite()) break;
    const Vector from = amplitudes;
    const double before = norm;
    double t = 1.0;
    // The shortest step is taken in any case: kinks are passed rather than stopped at.
    for (int halving = 0; halving <= kBalanceHalvings; ++halving, t *= 0.5) {
      amplitudes = from - t * step;
      norm = evaluate();
      if (norm < before) break;
    }
  }
  for (int c = 0; c < count_; ++c) amplitudes_[static_cast<std::size_t>(c)] = amplitudes[c];
}

void ContactCorrection::correct(std::span<const double> uncorrected,
                                std::span<double> direction) const {
  const std::size_t terms = static_cast<std::size_t>(count_) * direction.size();
  ThreadTeam* const team = terms < kTermsWorthSharing ? nullptr : team_;
  // Cut by unknowns, so that each sum has one order whoever forms it.
  share_from_both_ends(team, kSlices, [&](std::size_t slice, int) {
    const std::size_t begin = direction.size() * slice / kSlices;
    const std::size_t end = direction.size() * (slice + 1) / kSlices;
    for (std::size_t k = begin; k < end; ++k) direction[k] = uncorrected[k];
    for (int c = 0; c < count_; ++c) {
      const double amplitude = amplitudes_[static_cast<std::size_t>(c)];
      if (amplitude == 0.0) continue;
      const std::vector<double>& z = columns_[static_cast<std::size_t>(c)].response;
      for (std::size_t k = begin; k < end; ++k) direction[k] -= amplitude * z[k];
    }
  });
}

void ContactCorrection::start(const ContactPotential& contact, std::span<const Vector3> positions) {
  way_ = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    start_[i] = contact.respond(i, positions[i]).gradient;
  }
}

void ContactCorrection::move_obstacles(std::span<const Vector3> carried, double way) {
  way_ = way;
  for (std::size_t i = 0; i < carried.size(); ++i) start_[i] += carried[i];
}

void ContactCorrection::apply(const ContactPotential& contact, const StiffnessAssembly& assembly,
                              std::span<const Vector3> positions, double gradient_norm,
                              std::span<double> direction) {
  std::copy(direction.begin(), direction.end(), uncorrected_.begin());
  std::fill(amplitudes_.begin(), amplitudes_.end(), 0.0);
  const double threshold = kWorthwhile * gradient_norm;
  // Skin pushed away at one sample lands on or leaves others, which then need columns too.
  for (int round = 0; round < kRounds; ++round) {
    if (count_ > 0) {
      balance(contact, positions, kBalanceAccuracy * gradient_norm, uncorrected_);
      correct(uncorrected_, direction);
    }
    if (!add_columns(contact, assembly, positions, threshold, direction)) return;
  }
  balance(contact, positions, kBalanceAccuracy * gradient_norm, uncorrected_);
  correct(uncorrected_, direction);
}

}  // namespace softfinger
