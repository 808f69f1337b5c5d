#include "softfinger/identification/indentation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "softfinger/base/error.hpp"
#include "softfinger/contact/deepest_point.hpp"
#include "softfinger/finger/finger_contact.hpp"
#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/finger/minimise_in_cone.hpp"

namespace softfinger {
namespace {

/// Quasi-static increments are no longer than this, so that friction sees the path, m.
constexpr double kLongestIncrement = 0.1e-3;
/// Time steps are no longer than this, s, and no step moves the bone further than this, m.
constexpr double kLongestStep = 1e-3;
constexpr double kLongestMove = 0.01e-3;
/// As near as this skin touches, m.
constexpr double kTouching = 1e-8;
constexpr int kDescents = 40;
/// A press comes down from here, m.
constexpr double kHighest = 0.2;
constexpr int kMarches = 20000;
constexpr int kFrictionPasses = 40;
/// Larger than any finger, so that an edge has one face on top and one on its side only, m.
constexpr double kBlock = 0.5;

/// Way from one row to the next; depths in rows.
struct Stretch {
  int from, to;
  double duration;  ///< s; 0: quasi-static
  int increments;
};

std::vector<Stretch> course(const IndentationOptions& options) {
  const double length = options.depth / options.rows;
  const double duration = options.speed > 0.0 ? length / options.speed : 0.0;
  const auto parts = [](double whole, double longest) {
    return std::max(1, static_cast<int>(std::ceil(whole / longest - 1e-9)));
  };
  const int increments = duration > 0.0
                             ? std::max(parts(duration, kLongestStep), parts(length, kLongestMove))
                             : parts(length, kLongestIncrement);
  std::vector<Stretch> course;
  course.reserve(3 * static_cast<std::size_t>(options.rows));
  for (int k = 0; k < options.rows; ++k) course.push_back({k, k + 1, duration, increments});
  if (options.hold > 0.0) {
    const double pause = options.hold / options.rows;
    const Stretch still{options.rows, options.rows, pause, parts(pause, kLongestStep)};
    course.insert(course.end(), static_cast<std::size_t>(options.rows), still);
  }
  for (int k = options.rows; options.unload && k > 0; --k) {
    course.push_back({k, k - 1, duration, increments});
  }
  return course;
}

/// Least gap of the triangle to the solid, m.
double least_gap(const Shape& shape, const std::array<Vector3, 3>& corners_O) {
  TrianglePoint best = least_of_few(shape, {}, corners_O);
  for (std::size_t k = 0; k < 3; ++k) {
    const double gap = distance_and_gradient(shape, corners_O[k]).distance;
    if (gap >= best.gap) continue;
    best = {{}, gap};
    best.weights[k] = 1.0;
  }
  for (int i = 0; i < kDescents; ++i) {
    const TrianglePoint found = deepest_point(shape, {}, corners_O, best);
    const bool done = found.gap > best.gap - kTouching;
    best = found;
    if (done) break;
  }
  return best.gap;
}

/// Where F's origin is when the resting skin, as its triangles have it, first touches the obstacle
/// on its way down: the height z of F. None where it never does.
std::optional<double> touching_height(const FingerModel& model, const Obstacle& obstacle,
                                      const Matrix3& R_WF) {
  const Shape& shape = *obstacle.shape;
  const Pose X_OW = obstacle.X_WO.inverse();
  std::vector<Vector3> corners(model.sample_nodes.size());
  std::vector<double> gaps(corners.size());
  double z = kHighest;
  // The gap grows no faster than the way: marching by it passes nothing.
  for (int i = 0; i < kMarches && z > -kHighest; ++i) {
    const Pose X_OF = X_OW * Pose{R_WF, Vector3(0.0, 0.0, z)};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < corners.size(); ++s) {
      corners[s] = X_OF * model.mesh.nodes[static_cast<std::size_t>(model.sample_nodes[s])];
      gaps[s] = distance_and_gradient(shape, corners[s]).distance;
      least = std::min(least, gaps[s]);
    }
    for (const auto& triangle : model.skin_triangles) {
      if (std::holds_alternative<HalfSpace>(shape)) break;
      std::array<Vector3, 3> c;
      double nearest = std::numeric_limits<double>::infinity();
      double longest = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        c[k] = corners[static_cast<std::size_t>(triangle[k])];
        nearest = std::min(nearest, gaps[static_cast<std::size_t>(triangle[k])]);
        const auto next = static_cast<std::size_t>(triangle[(k + 1) % 3]);
        longest = std::max(longest, (corners[next] - c[k]).norm());
      }
      if (nearest - longest < least) least = std::min(least, least_gap(shape, c));
    }
    if (least < kTouching) return z;
    z -= least;
  }
  return std::nullopt;
}

}  // namespace

Indenter Indenter::plane() { return {}; }

Indenter Indenter::ball(double radius, double at_x, double at_y) {
  return {Ball{radius}, Vector3(at_x, at_y, -radius)};
}

Indenter Indenter::edge(double edge_radius) {
  return {RoundedBox{Vector3::Constant(kBlock), edge_radius}, Vector3(-kBlock, 0.0, -kBlock)};
}

void indent(const FingerModel& model, const Indenter& indenter, const IndentationOptions& options,
            const std::function<void(const IndentationState&)>& visit) {
  FingerPotential::Options potential_options;
  potential_options.strain_limits = options.strain_limits;
  FingerPotential potential(model, FingerPotential::Bone::kPrescribed, 1, potential_options);
  Obstacle obstacle;
  obstacle.shape = &indenter.shape;
  obstacle.X_WO.translation = indenter.p_FO_W;
  obstacle.friction_coefficient = options.friction ? model.friction_coefficient : 0.0;
  std::vector<FrictionAnchor> anchors = potential.contact().no_anchors();
  ContactSet contact = make_contact_set(model);
  StressHistory history = potential.elastic().make_history();

  Pose X_WF{exp_rotation(Vector3(0.0, options.pitch, 0.0)), Vector3::Zero()};
  const std::optional<double> touched = touching_height(model, obstacle, X_WF.rotation);
  if (!touched) {
    throw InputError("press: the finger comes down beside the obstacle and never touches it");
  }
  const double touch = *touched;
  X_WF.translation.z() = touch;
  std::vector<Vector3> positions;
  for (const Vector3& X : model.mesh.nodes) positions.push_back(X_WF * X);
  std::vector<Vector3> velocities(positions.size(), Vector3(0.0, 0.0, -options.speed));

  const double row_length = options.depth / options.rows;
  NewtonOptions newton;
  newton.tolerance = options.tolerance;
  newton.max_iterations = 200;

  double time = 0.0;
  for (const Stretch& stretch : course(options)) {
    IndentationRow row;
    row.indentation = options.depth * stretch.to / options.rows;
    time += stretch.duration;
    row.time = time;
    for (int j = 1; j <= stretch.increments; ++j) {
      const double part = static_cast<double>(j) / stretch.increments;
      X_WF.translation.z() =
          touch - row_length * (stretch.from + (stretch.to - stretch.from) * part);
      FingerPotential::Step step;
      step.time_step = stretch.duration / stretch.increments;
      step.old_positions = positions;
      step.velocities = velocities;
      step.X_WFt = X_WF;
      step.obstacles = {&obstacle, 1};
      step.anchors = anchors;
      step.history = &history;
      step.relaxed = options.relaxed;
      potential.begin(step);
      row.converged = false;
      for (int pass = 0; pass < kFrictionPasses; ++pass) {
        potential.start_from(
            pass == 0 ? std::span<const Vector3>(positions) : potential.positions(), X_WF);
        const NewtonSummary summary = untangle_and_minimise(potential, newton);
        row.iterations += summary.iterations;
        row.converged = summary.converged;
        potential.settle();
        if (potential.contact().update_limits(anchors) < options.friction_tolerance) break;
      }
      for (std::size_t n = 0; n < positions.size(); ++n) {
        const Vector3 moved = potential.positions()[n] - positions[n];
        if (step.time_step > 0.0) velocities[n] = moved / step.time_step;
        positions[n] += moved;
      }
      potential.elastic().end_step(potential.elastic_work(), step.time_step, history);
      if (j == stretch.increments) {
        report_contact(model, potential, contact);
        row.residual = potential.largest_free_force();
        const auto stretches = potential.elastic().stretches(potential.elastic_work());
        row.max_stretch = stretches.max;
        row.min_stretch = stretches.min;
        row.volume_ratio = potential.elastic().volume_ratio(potential.positions());
      }
      potential.contact().update_anchors(potential.contact_positions(), anchors);
    }
    row.normal_force = contact.normal_force;
    row.normal_force_sum = contact.normal_force_sum;
    row.tangential_force = contact.tangential_force;
    row.contact_area = contact.contact_area;
    row.slip_ratio = contact.slip_ratio;
    row.stuck_fraction = contact.stuck_fraction;
    row.contact_samples = contact.contact_count;
    visit({row, positions, contact, X_WF, potential.elastic().patch_of_tetrahedron()});
  }
}

}  // namespace softfinger
