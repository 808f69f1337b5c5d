// Newton's direction of an IslandProblem.
#include <algorithm>

#include "softfinger/world/island_problem.hpp"

namespace softfinger {

bool IslandProblem::factorise(HessianKind kind) {
  settle();
  for_each_partner([&](Partner& partner) {
    FingerPotential& finger = partner.finger->potential();
    partner.forget();
    if (is_soft_) parts_.soft.forget_factor(partner.number);
    if (!finger.factorise(kind)) return;
    for (const std::size_t b : bodies_) {
      if (partner.bodies.size() == partner.couplings.size()) break;
      ObstacleCoupling& coupling = partner.couplings[partner.bodies.size()];
      finger.couple(parts_.tree.bodies()[b].object, kind, coupling);
      if (coupling.touches) partner.bodies.push_back(b);
    }
    partner.find_yielding();
    partner.coupled = true;
  });
  if (!has_factor()) return false;
  if (!partners_.empty()) {
    arrange_system();
    system_is_current_ = false;
  }
  return build_system();
}

void IslandProblem::couple(std::size_t a, std::size_t b) {
  for (const BodyTree::Column& row : columns_[a].all()) {
    for (const BodyTree::Column& column : columns_[b].all()) {
      const int i = block_of_coordinate_[static_cast<std::size_t>(row.coordinate)];
      const int j = block_of_coordinate_[static_cast<std::size_t>(column.coordinate)];
      system_.couple(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
    }
  }
}

void IslandProblem::arrange_system() {
  freedoms_.clear();
  parts_.tree.columns(bodies_, current_.places, time_, columns_);
  for (const std::size_t b : bodies_) {
    const Body& body = parts_.tree.bodies()[b];
    if (body.freedoms == 0) continue;
    for (int c = 0; c < body.freedoms; ++c) {
      const auto coordinate = static_cast<std::size_t>(body.first + c);
      block_of_coordinate_[coordinate] = static_cast<int>(freedoms_.size());
      first_of_coordinate_[coordinate] = body.first;
    }
    freedoms_.push_back(body.freedoms);
  }
  side_.resize(6 * freedoms_.size());
  system_.begin(freedoms_.size());
  for (const std::size_t b : bodies_) couple(b, b);
  std::size_t last_of = parts_.X_WO.size();
  std::size_t last_on = last_of;
  parts_.contact.for_each_near(number_, [&](std::size_t of, std::size_t on) {
    if (of == last_of && on == last_on) return;
    last_of = of;
    last_on = on;
    const int a = parts_.tree.body_of(of);
    const int b = parts_.tree.body_of(on);
    if (a >= 0 && b >= 0) couple(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  });
  for (const Partner* partner : partners_) {
    for (const std::size_t a : partner->bodies) {
      for (const std::size_t b : partner->bodies) couple(a, b);
    }
  }
  system_.arrange();
}

void IslandProblem::add_pair(std::size_t a, std::size_t b, const Matrix6& block) {
  const auto place = [&](int coordinate) {
    const auto c = static_cast<std::size_t>(coordinate);
    return std::pair(static_cast<std::size_t>(block_of_coordinate_[c]),
                     coordinate - first_of_coordinate_[c]);
  };
  for (const BodyTree::Column& row : columns_[a].all()) {
    const Vector6 by_row = block.transpose() * row.twist;
    const auto [i, r] = place(row.coordinate);
    for (const BodyTree::Column& column : columns_[b].all()) {
      const auto [j, c] = place(column.coordinate);
      const double value = by_row.dot(column.twist);
      if (i == j && a != b) {
        // Both of two bodies that hang on this coordinate's.
        system_.add(i, r, j, c, value);
        system_.add(i, c, j, r, value);
      } else if (a != b || i >= j) {
        system_.add(i, r, j, c, value);
      }
    }
  }
}

void IslandProblem::add_contact() {
  // Those of two objects follow one another: they are added up first.
  int of = -1;
  int on = -1;
  std::size_t of_object = parts_.X_WO.size();
  std::size_t on_object = of_object;
  Matrix6 by_of = Matrix6::Zero();
  Matrix6 by_both = Matrix6::Zero();
  Matrix6 by_on = Matrix6::Zero();
  const auto add_up = [&] {
    const auto a = static_cast<std::size_t>(of);
    const auto b = static_cast<std::size_t>(on);
    if (of >= 0) add_pair(a, a, by_of);
    if (on >= 0) add_pair(b, b, by_on);
    if (of >= 0 && on >= 0) add_pair(a, b, by_both);
  };
  parts_.contact.for_each_touch(number_, [&](const SolidContact::Touch& touch) {
    if (touch.of != of_object || touch.on != on_object) {
      add_up();
      of_object = touch.of;
      on_object = touch.on;
      of = parts_.tree.body_of(of_object);
      on = parts_.tree.body_of(on_object);
      for (Matrix6* sum : {&by_of, &by_both, &by_on}) sum->setZero();
    }
    const auto arm = [&](std::size_t object) {
      Matrix36 by_pose;
      by_pose << Matrix3::Identity(), -skew(touch.at - parts_.X_WO[object].translation);
      return by_pose;
    };
    const Matrix36 arm_of = arm(touch.of);
    const Matrix36 arm_on = arm(touch.on);
    const Matrix36 pressed = touch.stiffness * arm_of;
    if (of >= 0) by_of.noalias() += arm_of.transpose().lazyProduct(pressed);
    if (of >= 0 && on >= 0) by_both.noalias() -= pressed.transpose().lazyProduct(arm_on);
    if (on >= 0) {
      const Matrix36 pressing = touch.stiffness * arm_on;
      by_on.noalias() += arm_on.transpose().lazyProduct(pressing);
    }
  });
  add_up();
}

bool IslandProblem::build_system() {
  if (system_is_current_) return true;
  system_.clear(freedoms_);
  for (const std::size_t b : bodies_) {
    Matrix6 own = parts_.motions[b].hessian(current_.places[b].X_WO);
    if (const BodyPull* const by = parts_.forces.pull_on(b)) {
      own += by->hessian(current_.places[b].X_WO);
    }
    add_pair(b, b, own);
    if (parts_.forces.law(b) == nullptr) continue;
    const auto c = static_cast<std::size_t>(parts_.tree.bodies()[b].first);
    const auto block = static_cast<std::size_t>(block_of_coordinate_[c]);
    system_.add(block, 0, block, 0, parts_.forces.joint(b, current_.places[b].q).stiffness);
  }
  add_contact();
  for (const Partner* partner : partners_) {
    const std::size_t stride = partner->couplings.size();
    for (std::size_t k = 0; k < partner->bodies.size(); ++k) {
      const Matrix6 own = partner->couplings[k].by_obstacle + partner->yielding[k * stride + k];
      add_pair(partner->bodies[k], partner->bodies[k], own);
      for (std::size_t l = 0; l < k; ++l) {
        add_pair(partner->bodies[k], partner->bodies[l], partner->yielding[k * stride + l]);
      }
    }
  }
  system_is_current_ = system_.factor();
  return system_is_current_;
}

void IslandProblem::solve_system(std::span<double> by_coordinate) {
  for (const bool back : {false, true}) {
    if (back) system_.solve(side_);
    for (const std::size_t b : bodies_) {
      const Body& body = parts_.tree.bodies()[b];
      for (int c = 0; c < body.freedoms; ++c) {
        const auto coordinate = static_cast<std::size_t>(body.first + c);
        const auto block = static_cast<std::size_t>(block_of_coordinate_[coordinate]);
        double& side = side_[6 * block + static_cast<std::size_t>(c)];
        if (back) {
          by_coordinate[coordinate] = side;
        } else {
          side = by_coordinate[coordinate];
        }
      }
    }
  }
}

Vector6 IslandProblem::twist_of(std::size_t body) const {
  Vector6 twist = Vector6::Zero();
  for (const BodyTree::Column& column : columns_[body].all()) {
    twist += direction_[static_cast<std::size_t>(column.coordinate)] * column.twist;
  }
  return twist;
}

double IslandProblem::solve_direction(bool refined) {
  settle();
  const auto for_each_coordinate = [&](const auto& visit) {
    for (const std::size_t b : bodies_) {
      const Body& body = parts_.tree.bodies()[b];
      for (int c = body.first; c < body.first + body.freedoms; ++c) {
        visit(static_cast<std::size_t>(c));
      }
    }
  };
  for_each_coordinate([&](std::size_t c) { direction_[c] = -current_.gradient[c]; });
  for_each_partner([](Partner& partner) { partner.finger->potential().solve_alone(); });
  for (const Partner* partner : partners_) {
    for (std::size_t k = 0; k < partner->bodies.size(); ++k) {
      const Vector6 load = partner->load(k);
      for (const BodyTree::Column& column : columns_[partner->bodies[k]].all()) {
        direction_[static_cast<std::size_t>(column.coordinate)] -= column.twist.dot(load);
      }
    }
  }
  // Contact between objects changes within a step; their system is small enough to be built anew.
  if (!build_system()) return 0.0;
  solve_system(direction_);
  for_each_partner([&](Partner& partner) {
    for (std::size_t k = 0; k < partner.bodies.size(); ++k) {
      partner.finger->potential().yield_to(partner.couplings[k], twist_of(partner.bodies[k]));
    }
  });
  if (pairs_may_meet()) bend_to_soft_contact(refined);
  if (refined) correct_directions();
  double slope = 0.0;
  for_each_coordinate([&](std::size_t c) { slope += direction_[c] * current_.gradient[c]; });
  for (const Partner* partner : partners_) slope += partner->finger->potential().slope();
  return slope;
}

void IslandProblem::bend_to_soft_contact(bool refined) {
  SoftContact& soft = parts_.soft;
  if (!soft.find_pairs(team_)) return;
  const auto rows = static_cast<Eigen::Index>(3 * soft.size());
  const auto freedoms = static_cast<Eigen::Index>(direction_.size());
  const bool touches = std::ranges::any_of(
      partners_, [](const Partner* partner) { return !partner->bodies.empty(); });
  auto pulled = pulled_.topLeftCorner(freedoms, rows);
  auto yielding = yielding_.topLeftCorner(freedoms, rows);
  if (touches) {
    pulled.setZero();
    for (const Partner* partner : partners_) {
      for (std::size_t k = 0; k < partner->bodies.size(); ++k) {
        for (std::size_t p = 0; p < soft.size(); ++p) {
          Matrix36 by_pose;
          for (std::size_t c = 0; c < 6; ++c) {
            by_pose.col(static_cast<Eigen::Index>(c)) =
                soft.way(p, partner->number, partner->couplings[k].responses[c]);
          }
          for (const BodyTree::Column& column : columns_[partner->bodies[k]].all()) {
            pulled.block<1, 3>(column.coordinate, static_cast<Eigen::Index>(3 * p)) +=
                (by_pose * column.twist).transpose();
          }
        }
      }
    }
    yielding = pulled;
    for (Eigen::Index c = 0; c < rows; ++c) {
      solve_system({yielding_.col(c).data(), direction_.size()});
    }
    // Of columns that lie together, without the memory that a blocked product takes.
    soft.compliance() += pulled.transpose().lazyProduct(yielding);
  }
  const std::span<const double> forces = soft.balance(refined);
  for_each_partner([&](Partner& partner) { soft.apply(partner.number); });
  if (!touches) return;
  Eigen::Map<Eigen::VectorXd>(recoil_.data(), freedoms).noalias() =
      yielding * Eigen::Map<const Eigen::VectorXd>(forces.data(), rows);
  for (std::size_t c = 0; c < direction_.size(); ++c) direction_[c] += recoil_[c];
  recoil_.swap(direction_);  // for twist_of()
  for_each_partner([&](Partner& partner) {
    for (std::size_t k = 0; k < partner.bodies.size(); ++k) {
      partner.finger->potential().yield_to(partner.couplings[k], twist_of(partner.bodies[k]));
    }
  });
  recoil_.swap(direction_);
}

void IslandProblem::correct_directions() {
  if (partners_.empty()) return;
  for_each_partner([](Partner& partner) { partner.finger->potential().start_correction(); });
  parts_.tree.advance(bodies_, current_.places, direction_, 1.0, time_, expected_);
  double way = 0.0;
  for (const std::size_t b : bodies_) {
    const Vector6 twist = twist_of(b);
    way = std::max(way, twist.head<3>().norm() + twist.tail<3>().norm() * parts_.forces.reach(b));
  }
  show(expected_);
  for_each_partner([&](Partner& partner) {
    std::ranges::fill(partner.carried, Vector3::Zero());
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
