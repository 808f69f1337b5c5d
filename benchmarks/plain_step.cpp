#include "plain_step.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/finger/finger_potential.hpp"

namespace softfinger {
namespace {

constexpr double kTolerance = 1e-6;
constexpr double kFineTolerance = 1e-8;
constexpr int kMaxIterations = 200;
// As softfinger/finger/finger_potential.cpp measures residuals.
constexpr double kLeverArm = 8e-3;    // m
constexpr double kForceFloor = 1e-3;  // N
constexpr int kConePasses = 40;

}  // namespace

PlainStep::PlainStep(std::shared_ptr<const FingerModel> model,
                     std::span<const VirtualObject> objects, double time_step)
    : model_(std::move(model)),
      objects_(objects),
      time_step_(time_step),
      elasticity_(*model_),
      bone_potential_(bone_inertia(*model_, elasticity_.masses()), model_->coupling),
      contact_(model_->sample_rest_areas, model_->sample_rest_areas.size(), objects.size(),
               contact_options(*model_)),
      positions_(model_->mesh.nodes),
      velocities_(positions_.size(), Vector3::Zero()),
      obstacles_(objects.size()),
      predicted_(positions_),
      node_gradient_(positions_),
      sample_positions_(model_->sample_nodes.size()),
      sample_gradient_(sample_positions_),
      starts_(sample_positions_) {
  for (std::size_t n = 0; n < positions_.size(); ++n) {
    first_unknown_.push_back(model_->node_is_rigid[n] ? -1 : unknowns_);
    if (!model_->node_is_rigid[n]) unknowns_ += 3;
  }
  unknowns_ += 6;
  for (std::size_t o = 0; o < objects.size(); ++o) {
    obstacles_[o].shape = &objects[o].shape;
    obstacles_[o].friction_coefficient =
        objects[o].friction_coefficient.value_or(model_->friction_coefficient);
  }
  for (Point* point : {&current_, &trial_}) {
    point->positions = positions_;
    point->gradient.resize(unknowns_);
  }
  reset(Pose{});
}

void PlainStep::reset(const Pose& X_WFt) {
  bone_ = BoneState{};
  bone_.X_WF = tracked_ = X_WFt;
  for (std::size_t n = 0; n < positions_.size(); ++n) {
    positions_[n] = X_WFt * model_->mesh.nodes[n];
    velocities_[n].setZero();
  }
  anchors_ = contact_.no_anchors();
}

void PlainStep::note_starts() {
  for (std::size_t i = 0; i < starts_.size(); ++i) {
    starts_[i] = positions_[static_cast<std::size_t>(model_->sample_nodes[i])];
  }
}

void PlainStep::place_obstacles(double time) {
  for (std::size_t o = 0; o < objects_.size(); ++o) {
    obstacles_[o].X_WO_old = objects_[o].motion.sample(time - time_step_);
    obstacles_[o].X_WO = objects_[o].motion.sample(time);
  }
}

void PlainStep::put_tied_nodes(Point& point) const {
  for (std::size_t n = 0; n < point.positions.size(); ++n) {
    if (first_unknown_[n] < 0) point.positions[n] = point.X_WF * model_->mesh.nodes[n];
  }
}

PlainStep::NodeMotion PlainStep::motion(std::size_t node, const Point& point) const {
  NodeMotion result;
  if (first_unknown_[node] >= 0) {
    result.parts[result.count++].first = first_unknown_[node];
    return result;
  }
  // A tied node moves with the bone: dx = dc + dtheta x r.
  const Vector3 arm = point.positions[node] - point.X_WF.translation;
  result.parts[result.count++].first = unknowns_ - 6;
  result.parts[result.count++] = {unknowns_ - 3, -skew(arm)};
  return result;
}

void PlainStep::read_samples(const Point& point) {
  for (std::size_t i = 0; i < sample_positions_.size(); ++i) {
    sample_positions_[i] = point.positions[static_cast<std::size_t>(model_->sample_nodes[i])];
    sample_gradient_[i].setZero();
  }
}

void PlainStep::evaluate(Point& point) {
  std::fill(node_gradient_.begin(), node_gradient_.end(), Vector3::Zero());
  point.energy = elasticity_.energy_gradient(point.positions, node_gradient_);
  read_samples(point);
  point.energy += contact_.energy_gradient(sample_positions_, sample_gradient_);
  for (std::size_t i = 0; i < sample_gradient_.size(); ++i) {
    node_gradient_[static_cast<std::size_t>(model_->sample_nodes[i])] += sample_gradient_[i];
  }
  double inertia_squared = 0.0;
  for (std::size_t n = 0; n < predicted_.size(); ++n) {
    if (first_unknown_[n] < 0) continue;  // part of the bone's inertia
    const Vector3 moved = point.positions[n] - predicted_[n];
    const Vector3 force = elasticity_.masses()[n] / (time_step_ * time_step_) * moved;
    point.energy += 0.5 * force.dot(moved);
    node_gradient_[n] += force;
    inertia_squared += force.squaredNorm();
  }
  const BonePotential::Value bone = bone_potential_.evaluate(point.X_WF);
  point.energy += bone.energy;
  inertia_squared += bone.inertia_norm * bone.inertia_norm;

  point.gradient.setZero();
  point.gradient.segment<3>(unknowns_ - 6) = bone.by_translation;
  point.gradient.segment<3>(unknowns_ - 3) = bone.by_rotation;
  for (std::size_t n = 0; n < node_gradient_.size(); ++n) {
    const NodeMotion moves = motion(n, point);
    for (const Motion& part : moves.all()) {
      point.gradient.segment<3>(part.first) += part.by_unknowns.transpose() * node_gradient_[n];
    }
  }
  const double squared_norm = point.gradient.head(unknowns_ - 3).squaredNorm() +
                              point.gradient.tail<3>().squaredNorm() / (kLeverArm * kLeverArm);
  const double scale = std::max(
      {std::sqrt(inertia_squared), contact_.force_norm(), bone.coupling_norm, kForceFloor});
  point.residual = std::sqrt(squared_norm) / scale;
}

void PlainStep::add_block(int row, int column, const Matrix3& block) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (row + i >= column + j) triplets_.emplace_back(row + i, column + j, block(i, j));
    }
  }
}

void PlainStep::add_block(const NodeMotion& a, const NodeMotion& b, const Matrix3& block) {
  for (const Motion& row : a.all()) {
    for (const Motion& column : b.all()) {
      add_block(row.first, column.first, row.by_unknowns.transpose() * block * column.by_unknowns);
    }
  }
}

void PlainStep::assemble() {
  triplets_.clear();
  for (std::size_t e = 0; e < elasticity_.elements(); ++e) {
    const PlainElasticity::ElementHessian h = elasticity_.hessian(e, current_.positions);
    std::array<NodeMotion, 4> moves;
    for (std::size_t a = 0; a < 4; ++a) {
      moves[a] = motion(static_cast<std::size_t>(elasticity_.nodes(e)[a]), current_);
    }
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        add_block(moves[static_cast<std::size_t>(a)], moves[static_cast<std::size_t>(b)],
                  h.block<3, 3>(3 * a, 3 * b));
      }
    }
  }
  Matrix3 block;
  for (std::size_t i = 0; i < sample_positions_.size(); ++i) {
    if (!contact_.hessian(i, false, block)) continue;
    const NodeMotion moves = motion(static_cast<std::size_t>(model_->sample_nodes[i]), current_);
    add_block(moves, moves, block);
  }
  for (std::size_t n = 0; n < predicted_.size(); ++n) {
    if (first_unknown_[n] < 0) continue;
    const double stiffness = elasticity_.masses()[n] / (time_step_ * time_step_);
    add_block(first_unknown_[n], first_unknown_[n], stiffness * Matrix3::Identity());
  }
  const BonePotential::Hessian bone = bone_potential_.hessian(current_.X_WF, true);
  add_block(unknowns_ - 6, unknowns_ - 6, bone.translation);
  add_block(unknowns_ - 3, unknowns_ - 6, bone.translation_rotation.transpose());
  add_block(unknowns_ - 3, unknowns_ - 3, bone.rotation);
}

bool PlainStep::line_search(const Eigen::VectorXd& direction) {
  constexpr double kArmijo = 1e-4;
  constexpr double kSlack = 1e-13;  // near the minimum, differences drown in rounding
  const double slope = direction.dot(current_.gradient);
  for (double t = 1.0; t > 1e-7; t *= 0.5) {
    for (std::size_t n = 0; n < positions_.size(); ++n) {
      if (first_unknown_[n] < 0) continue;
      trial_.positions[n] = current_.positions[n] + t * direction.segment<3>(first_unknown_[n]);
    }
    trial_.X_WF.translation = current_.X_WF.translation + t * direction.segment<3>(unknowns_ - 6);
    trial_.X_WF.rotation = exp_rotation(t * direction.tail<3>()) * current_.X_WF.rotation;
    put_tied_nodes(trial_);
    evaluate(trial_);
    if (trial_.energy <=
        current_.energy + kArmijo * t * slope + kSlack * std::abs(current_.energy)) {
      std::swap(current_, trial_);
      return true;
    }
  }
  return false;
}

StepSummary PlainStep::solve(const Pose& X_WFt, double time) {
  place_obstacles(time);
  note_starts();
  limited_ = anchors_;
  contact_.begin(obstacles_, limited_, starts_);
  bone_potential_.begin(bone_, tracked_, X_WFt, time_step_);
  for (std::size_t n = 0; n < positions_.size(); ++n) {
    predicted_[n] = positions_[n] + time_step_ * velocities_[n];
  }
  current_.positions = predicted_;
  current_.X_WF.translation = bone_.X_WF.translation + time_step_ * bone_.velocity;
  current_.X_WF.rotation = orthonormalised(bone_.X_WF.rotation + time_step_ * bone_.rotation_rate);
  put_tied_nodes(current_);
  evaluate(current_);

  return minimise_in_cone();
}

/// Again with the limits of the normal forces that were found, until friction is within them.
StepSummary PlainStep::minimise_in_cone() {
  StepSummary summary = minimise(kTolerance);
  for (int pass = 0; pass < kConePasses && !contact_.is_in_cone(); ++pass) {
    contact_.update_limits(limited_, pass > 0);
    evaluate(current_);
    const StepSummary again = minimise(kTolerance);
    summary = {summary.iterations + again.iterations, again.converged, again.relative_residual};
  }
  evaluate(current_);
  summary.converged = summary.converged && contact_.is_in_cone();
  return summary;
}

bool PlainStep::refine() { return minimise(kFineTolerance).converged; }

StepSummary PlainStep::minimise(double tolerance) {
  StepSummary summary;
  while (current_.residual > tolerance && summary.iterations < kMaxIterations) {
    ++summary.iterations;
    assemble();
    Eigen::SparseMatrix<double> matrix(unknowns_, unknowns_);
    matrix.setFromTriplets(triplets_.begin(), triplets_.end());
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(matrix);
    if (factor.info() != Eigen::Success) break;
    if (!line_search(-factor.solve(current_.gradient))) break;
  }
  summary.relative_residual = current_.residual;
  summary.converged = current_.residual <= tolerance;
  return summary;
}

double PlainStep::residual_at(std::span<const Vector3> positions, const Pose& X_WF) {
  trial_.positions.assign(positions.begin(), positions.end());
  trial_.X_WF = X_WF;
  evaluate(trial_);
  return trial_.residual;
}

void PlainStep::advance(std::span<const Vector3> positions, const Pose& X_WF, const Pose& X_WFt,
                        double time) {
  const double rate = 1.0 / time_step_;
  note_starts();
  for (std::size_t n = 0; n < positions_.size(); ++n) {
    velocities_[n] = rate * (positions[n] - positions_[n]);
    positions_[n] = positions[n];
  }
  bone_.velocity = rate * (X_WF.translation - bone_.X_WF.translation);
  bone_.rotation_rate = rate * (X_WF.rotation - bone_.X_WF.rotation);
  bone_.X_WF = X_WF;
  tracked_ = X_WFt;
  place_obstacles(time);
  contact_.begin(obstacles_, anchors_, starts_);
  for (std::size_t i = 0; i < sample_positions_.size(); ++i) {
    sample_positions_[i] = positions_[static_cast<std::size_t>(model_->sample_nodes[i])];
  }
  contact_.energy_gradient(sample_positions_, sample_gradient_);
  contact_.update_anchors(sample_positions_, anchors_);
}

}  // namespace softfinger
