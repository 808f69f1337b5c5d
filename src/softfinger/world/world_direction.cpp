// Newton's direction of a WorldProblem.
#include <algorithm>

#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/world/world_problem.hpp"

namespace softfinger {
namespace {

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

bool WorldProblem::factorise(HessianKind kind) {
  settle();
  has_factor_ = false;
  for_each_finger([&](Partner& partner) {
    FingerPotential& finger = partner.finger->potential();
    partner.bodies.clear();
    soft_.forget_factor(partner.number);
    if (!finger.factorise(kind)) return;
    for (std::size_t b = 0; b < motions_.size(); ++b) {
      if (partner.bodies.size() == partner.couplings.size()) break;
      ObstacleCoupling& coupling = partner.couplings[partner.bodies.size()];
      finger.couple(tree_.bodies()[b].object, kind, coupling);
      if (coupling.touches) partner.bodies.push_back(b);
    }
    partner.find_yielding();
  });
  has_factor_ = true;
  has_factor_ = has_factor();
  if (!has_factor_) return false;
  build_system();
  if (system_.size() == 0) return true;  // soft objects alone
  has_factor_ = Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(system_).info() == Eigen::Success;
  return has_factor_;
}

void WorldProblem::Partner::find_yielding() {
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    for (std::size_t l = 0; l < bodies.size(); ++l) {
      Matrix6& block = yielding[k * couplings.size() + l];
      for (int r = 0; r < 6; ++r) {
        for (int c = 0; c < 6; ++c) {
          block(r, c) = -dot(couplings[k].columns[static_cast<std::size_t>(r)],
                             couplings[l].responses[static_cast<std::size_t>(c)]);
        }
      }
    }
  }
}

void WorldProblem::add_pair(std::size_t a, std::size_t b, const Matrix6& block) {
  for (const BodyTree::Column& row : columns_[a].all()) {
    const Vector6 by_row = block.transpose() * row.twist;
    for (const BodyTree::Column& column : columns_[b].all()) {
      system_(row.coordinate, column.coordinate) += by_row.dot(column.twist);
    }
  }
}

void WorldProblem::build_system() {
  system_.setZero();
  for (std::size_t b = 0; b < motions_.size(); ++b) {
    add_pair(b, b, motions_[b].hessian(current_.places[b].X_WO));
    if (const BodyPull* const by = pull_on(b)) {
      add_pair(b, b, by->hessian(current_.places[b].X_WO));
    }
  }
  for (std::size_t b = 0; b < joints_.size(); ++b) {
    if (!joints_[b]) continue;
    const int c = tree_.bodies()[b].first;
    system_(c, c) += joint_value(*joints_[b], current_.places[b].q).stiffness;
  }
  contact_.for_each_touch([&](const SolidContact::Touch& touch) {
    const int of = tree_.body_of(touch.of);
    const int on = tree_.body_of(touch.on);
    const auto arm = [&](std::size_t object) {
      Matrix36 by_pose;
      by_pose << Matrix3::Identity(), -skew(touch.at - X_WO_[object].translation);
      return by_pose;
    };
    const Matrix36 by_of = arm(touch.of);
    const Matrix36 by_on = arm(touch.on);
    const auto a = static_cast<std::size_t>(of);
    const auto b = static_cast<std::size_t>(on);
    if (of >= 0) add_pair(a, a, by_of.transpose() * touch.stiffness * by_of);
    if (on >= 0) add_pair(b, b, by_on.transpose() * touch.stiffness * by_on);
    if (of >= 0 && on >= 0) {
      const Matrix6 cross = -by_of.transpose() * touch.stiffness * by_on;
      add_pair(a, b, cross);
      add_pair(b, a, cross.transpose());
    }
  });
  for (const Partner* partner : fingers_) {
    for (std::size_t k = 0; k < partner->bodies.size(); ++k) {
      const ObstacleCoupling& coupling = partner->couplings[k];
      add_pair(partner->bodies[k], partner->bodies[k], coupling.by_obstacle);
      for (std::size_t l = 0; l < partner->bodies.size(); ++l) {
        add_pair(partner->bodies[k], partner->bodies[l],
                 partner->yielding[k * partner->couplings.size() + l]);
      }
    }
  }
}

Vector6 WorldProblem::twist_of(std::size_t body) const {
  Vector6 twist = Vector6::Zero();
  for (const BodyTree::Column& column : columns_[body].all()) {
    twist += direction_[column.coordinate] * column.twist;
  }
  return twist;
}

double WorldProblem::solve_direction(bool refined) {
  settle();
  direction_ = -current_.gradient;
  for_each_finger([](Partner& partner) { partner.finger->potential().solve_alone(); });
  for (Partner* partner : fingers_) {
    const std::span<const double> alone = partner->finger->potential().direction();
    for (std::size_t k = 0; k < partner->bodies.size(); ++k) {
      Vector6 load;
      for (int c = 0; c < 6; ++c) {
        load[c] = dot(partner->couplings[k].columns[static_cast<std::size_t>(c)], alone);
      }
      for (const BodyTree::Column& column : columns_[partner->bodies[k]].all()) {
        direction_[column.coordinate] -= column.twist.dot(load);
      }
    }
  }
  // Contact between objects changes within a step; their system is small enough to be built anew.
  build_system();
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(system_);
  if (factor.info() != Eigen::Success) return 0.0;
  factor.solveInPlace(direction_);
  for_each_finger([&](Partner& partner) {
    for (std::size_t k = 0; k < partner.bodies.size(); ++k) {
      partner.finger->potential().yield_to(partner.couplings[k], twist_of(partner.bodies[k]));
    }
  });
  if (soft_.any()) bend_to_soft_contact(factor, refined);
  if (refined) correct_directions();
  double slope = direction_.dot(current_.gradient);
  for (const Partner* partner : fingers_) slope += partner->finger->potential().slope();
  return slope;
}

void WorldProblem::bend_to_soft_contact(const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>& factor,
                                        bool refined) {
  if (!soft_.find_pairs(team_)) return;
  const auto rows = static_cast<Eigen::Index>(3 * soft_.size());
  const Eigen::Index freedoms = direction_.size();
  const bool touches = std::ranges::any_of(
      fingers_, [](const Partner* partner) { return !partner->bodies.empty(); });
  auto pulled = pulled_.topLeftCorner(rows, freedoms);
  auto yielding = yielding_.topLeftCorner(freedoms, rows);
  if (touches) {
    pulled.setZero();
    for (const Partner* partner : fingers_) {
      for (std::size_t k = 0; k < partner->bodies.size(); ++k) {
        for (std::size_t p = 0; p < soft_.size(); ++p) {
          Matrix36 by_pose;
          for (std::size_t c = 0; c < 6; ++c) {
            by_pose.col(static_cast<Eigen::Index>(c)) =
                soft_.way(p, partner->number, partner->couplings[k].responses[c]);
          }
          for (const BodyTree::Column& column : columns_[partner->bodies[k]].all()) {
            pulled.block<3, 1>(static_cast<Eigen::Index>(3 * p), column.coordinate) +=
                by_pose * column.twist;
          }
        }
      }
    }
    yielding = pulled.transpose();
    for (Eigen::Index c = 0; c < rows; ++c) {
      Eigen::Ref<Eigen::VectorXd> column = yielding.col(c);
      factor.solveInPlace(column);
    }
    soft_.compliance() += pulled.lazyProduct(yielding);
  }
  const std::span<const double> forces = soft_.balance(refined);
  for_each_finger([&](Partner& partner) { soft_.apply(partner.number); });
  if (!touches) return;
  recoil_.noalias() = yielding * Eigen::Map<const Eigen::VectorXd>(forces.data(), rows);
  direction_ += recoil_;
  recoil_.swap(direction_);  // for twist_of()
  for_each_finger([&](Partner& partner) {
    for (std::size_t k = 0; k < partner.bodies.size(); ++k) {
      partner.finger->potential().yield_to(partner.couplings[k], twist_of(partner.bodies[k]));
    }
  });
  recoil_.swap(direction_);
}

void WorldProblem::correct_directions() {
  if (fingers_.empty()) return;
  for_each_finger([](Partner& partner) { partner.finger->potential().start_correction(); });
  tree_.advance(current_.places, {direction_.data(), static_cast<std::size_t>(direction_.size())},
                1.0, time_, expected_);
  double way = 0.0;
  for (std::size_t b = 0; b < expected_.size(); ++b) {
    const Vector6 twist = twist_of(b);
    way = std::max(way, twist.head<3>().norm() + twist.tail<3>().norm() * reaches_[b]);
  }
  show(expected_);
  for_each_finger([&](Partner& partner) {
    std::fill(partner.carried.begin(), partner.carried.end(), Vector3::Zero());
    FingerPotential& finger = partner.finger->potential();
    const std::size_t points = finger.contact_positions().size();
    for (std::size_t k = 0; k < partner.bodies.size(); ++k) {
      const Vector6 twist = twist_of(partner.bodies[k]);
      for (std::size_t i = 0; i < points; ++i) {
        partner.carried[i] += partner.couplings[k].by_point[i] * twist;
      }
    }
    finger.correct_direction({partner.carried.data(), points}, way);
  });
  show(current_.places);
}

}  // namespace softfinger
