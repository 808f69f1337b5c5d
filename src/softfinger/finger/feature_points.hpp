#pragma once

#include <array>
#include <span>
#include <vector>

#include "softfinger/contact/contact_potential.hpp"
#include "softfinger/contact/contact_report.hpp"
#include "softfinger/contact/contact_set.hpp"
#include "softfinger/finger/contact_correction.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// Points of the skin between its samples, where a feature of an obstacle (an edge, a corner, a
/// needle) finer than the triangles would else sink in. Each lies in a triangle where the obstacle
/// is deepest, a fixed small depth under the skin, so that they do nothing where the samples do
/// well enough, and so that a thin feature is met tip first: the nearest surface of a needle that
/// has passed through would be its side. Within a step each sees the obstacle as a plane: a point
/// of the skin held against a sharp edge would slide off it, where skin as a surface slides along.
/// They carry forces to the triangle's corners; those that bear force are members of the contact
/// set beside the samples.
///
/// A point keeps its place in the list as long as it may touch or the factored matrix knows it.
class FeaturePoints {
 public:
  static constexpr std::size_t kMost = ContactSet::kMostFeatures;
  static constexpr double kDepth = 5e-5;  ///< under the skin, m
  static constexpr double kArea = 2e-6;   ///< counts as this area where stiffness goes by area, m^2

  struct Point : FeaturePlace {
    int triangle = -1;  ///< of FingerModel::skin_triangles
    std::array<int, 3> nodes{};
    std::array<double, 3> way{};  ///< the last step's, to the deepest place, in weights
    double follow = 0.0;          ///< part of it that is gone in a step
    ContactPlane plane;           ///< the obstacle as the point meets it in this step
    ContactSide side;             ///< where the obstacle is met
    bool near = false;            ///< may touch in this step
  };

  /// What is known from step to step.
  struct State {
    std::array<Point, kMost> points;
    std::size_t count = 0;
  };

  FeaturePoints(const FingerModel& model, std::size_t obstacle_count);

  struct Step {
    std::span<const Vector3> positions;      ///< of all nodes where the step is looked for, W, m
    std::span<const Vector3> old_positions;  ///< and where it starts
    std::span<const Obstacle> obstacles;     ///< at the end of the step
  };
  /// Chooses the points of a step, which `contact` has begun. `correction` knows what the factored
  /// matrix holds, of samples and then of these points; `anchors` are these points' and follow
  /// them.
  void choose(const Step& step, const ContactPotential& contact,
              const ContactCorrection& correction, std::span<FrictionAnchor> anchors);
  void clear();
  void keep(State& state) const;
  /// False where other places are taken now than before, so that what knew them is out of date.
  bool restore(const State& state);

  [[nodiscard]] std::span<const Point> points() const { return {points_.data(), count_}; }
  [[nodiscard]] Vector3 position(const Point& point, std::span<const Vector3> nodes) const {
    Vector3 p = point.offset;
    for (std::size_t k = 0; k < 3; ++k) {
      p += point.weights[k] * nodes[static_cast<std::size_t>(point.nodes[k])];
    }
    return p;
  }

 private:
  struct Found {
    std::array<double, 3> weights{};
    Vector3 offset = Vector3::Zero();
    ContactPlane plane;
    ContactSide side;
    bool known = false;  ///< else it is too far off to say
    bool near = false;
  };
  [[nodiscard]] Found find(const Step& step, const ContactPotential& contact, std::size_t triangle,
                           std::size_t obstacle, const Point* known);
  /// A sample as one obstacle sees it.
  struct Corner {
    Vector3 position_O = Vector3::Zero();
    double bound = 0.0;  ///< of the gap, from below
    bool known = false;
    SignedDistance at;  ///< where known
  };
  void place_corners(const Step& step, const ContactPotential& contact, std::size_t obstacle);
  void release_last(const ContactCorrection& correction);
  /// A place in the list that nothing needs; kMost where there is none.
  [[nodiscard]] std::size_t free_place(const ContactCorrection& correction) const;
  void put(std::size_t k, std::size_t triangle, std::size_t obstacle, const Found& found,
           std::span<FrictionAnchor> anchors);
  void move(const Step& step, const ContactPotential& contact, std::size_t k, const Found& found,
            std::span<FrictionAnchor> anchors);
  /// The side from which the triangle meets the obstacle: of its deepest corner that touches.
  [[nodiscard]] ContactSide side_of_triangle(const ContactPotential& contact, std::size_t triangle,
                                             std::size_t obstacle) const;
  /// Where the point with these weights went in during the step.
  [[nodiscard]] ContactSide side_on_way_of(const Step& step, const ContactPotential& contact,
                                           std::size_t triangle, std::size_t obstacle,
                                           const std::array<double, 3>& weights) const;

  const FingerModel& model_;
  std::vector<bool> is_free_;  ///< per triangle: no corner is tied
  std::vector<int> place_;     ///< per triangle and obstacle (obstacle fastest); -1: none
  std::size_t obstacle_count_;
  std::vector<Corner> corners_;  ///< per sample
  std::array<Point, kMost> points_;
  std::size_t count_ = 0;
};

}  // namespace softfinger
