#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/geometry/mesh_shape.hpp"
#include "softfinger/scene/scene.hpp"

// Features finer than the skin's triangles: how far they sink in between its vertices.
namespace softfinger {
namespace {

const std::filesystem::path kRoot = source_folder();
constexpr double kTimeStep = 1e-3;
constexpr double kMostSunk = 0.1 * mm;
constexpr double kMostSunkOnABlade = 0.11 * mm;

std::shared_ptr<const FingerModel> finger() {
  static const auto model = FingerModel::load(kRoot / "fingers/index.toml");
  return model;
}

VirtualObject object(Shape shape, const Vector3& position) {
  VirtualObject object;
  object.shape = std::move(shape);
  object.motion = Trajectory(std::vector<Waypoint>{{0.0, Pose{Matrix3::Identity(), position}}});
  return object;
}

/// How far the point p is inside the skin, along z: above the skin's lowest sheet. Negative
/// outside; -1 m where no skin is above or below.
double depth_in_skin(const FingerSimulation& simulation, const Vector3& p) {
  double lowest = 1.0;
  const FingerModel& model = simulation.model();
  for (const auto& triangle : model.skin_triangles) {
    std::array<Vector3, 3> c;
    for (std::size_t k = 0; k < 3; ++k) {
      const int node = model.sample_nodes[static_cast<std::size_t>(triangle[k])];
      c[k] = simulation.positions()[static_cast<std::size_t>(node)];
    }
    const auto cross = [](const Vector3& a, const Vector3& b) {
      return a.x() * b.y() - a.y() * b.x();
    };
    const double area = cross(c[1] - c[0], c[2] - c[0]);
    const double u = cross(c[1] - p, c[2] - p) / area;
    const double v = cross(c[2] - p, c[0] - p) / area;
    const double w = 1.0 - u - v;
    if (!(u >= 0.0 && v >= 0.0 && w >= 0.0)) continue;
    lowest = std::min(lowest, u * c[0].z() + v * c[1].z() + w * c[2].z());
  }
  return p.z() - lowest;
}

struct Pressed {
  double sunk = -1.0;  ///< most, m
  double force = 0.0;  ///< at the end, N
  double least = 1.0;  ///< while held, N
  int unconverged = 0;
};

/// Comes down on the obstacle at `speed` (m/s), by `depth` beyond touch, and stays.
Pressed press(const VirtualObject& obstacle, const Vector3& at, double depth,
              std::span<const Vector3> tips, double speed = 20.0 * mm) {
  FingerSimulation simulation(finger(), {&obstacle, 1}, kTimeStep);
  const double lowest = -7.4 * mm;  // of the resting skin
  const double start = -lowest + 0.5 * mm;
  const double end = -lowest - depth;
  const auto pose = [&](double z) { return Pose{Matrix3::Identity(), at + Vector3(0, 0, z)}; };
  simulation.reset(pose(start));
  const int down = static_cast<int>((start - end) / speed / kTimeStep);
  Pressed pressed;
  for (int k = 1; k <= down + 300; ++k) {
    const double z = std::max(end, start - speed * k * kTimeStep);
    if (!simulation.step(pose(z), k * kTimeStep).converged) ++pressed.unconverged;
    for (const Vector3& tip : tips) {
      pressed.sunk = std::max(pressed.sunk, depth_in_skin(simulation, tip));
    }
    if (k > down + 100) {
      pressed.least = std::min(pressed.least, simulation.contact().normal_force);
    }
  }
  pressed.force = simulation.contact().normal_force;
  return pressed;
}

Shape mesh(const char* name) {
  return load_mesh_shape(kRoot / "objects" / name, {.unit = 1e-3, .edge_rounding = 0.1e-3});
}

/// Where the mesh's surface ends along z, as its grid has it: sharp features recede a little.
double top(const Shape& shape) {
  double low = -1.0 * mm;
  double high = 0.5 * mm;
  while (high - low > 1e-9) {
    const double middle = 0.5 * (low + high);
    (signed_distance(shape, {0, 0, middle}).distance > 0.0 ? high : low) = middle;
  }
  return low;
}

TEST(FeatureContact, PinDoesNotSinkBetweenVertices) {
  const VirtualObject pin =
      object(RoundedCylinder{0.3 * mm, 10.0 * mm, 0.1 * mm}, {0, 0, -10.0 * mm});
  const Vector3 tip = Vector3::Zero();
  for (const double x : {0.0, 0.35, 0.7, 1.1, 1.6}) {
    for (const double y : {0.0, 0.5, 1.0}) {
      const Pressed pressed = press(pin, {x * mm, y * mm, 0}, 1.5 * mm, {&tip, 1});
      EXPECT_LT(pressed.sunk, kMostSunk) << x << ' ' << y;
      EXPECT_GT(pressed.force, 0.05) << x << ' ' << y;
      EXPECT_EQ(pressed.unconverged, 0) << x << ' ' << y;
    }
  }
}

TEST(FeatureContact, NeedleDoesNotSinkBetweenVertices) {
  const Shape shape = mesh("needle.stl");
  const VirtualObject needle = object(shape, Vector3::Zero());
  const Vector3 tip(0, 0, top(shape));
  for (const double x : {0.0, 0.35, 0.7, 1.1}) {
    const Pressed pressed = press(needle, {x * mm, 0.4 * mm, 0}, 1.5 * mm, {&tip, 1});
    EXPECT_LT(pressed.sunk, kMostSunk) << x;
    EXPECT_GT(pressed.force, 0.05) << x;
    EXPECT_EQ(pressed.unconverged, 0) << x;
  }
}

TEST(FeatureContact, BladeDoesNotSinkBetweenVertices) {
  const Shape shape = mesh("blade.stl");
  const VirtualObject blade = object(shape, Vector3::Zero());
  std::vector<Vector3> edge;
  for (double y = -2.0; y <= 2.0; y += 0.1) edge.emplace_back(0, y * mm, top(shape));
  for (const double x : {0.0, 0.4, 0.8, 1.0, 1.3}) {
    const Pressed pressed = press(blade, {x * mm, 0, 0}, 1.5 * mm, edge);
    EXPECT_LT(pressed.sunk, kMostSunkOnABlade) << x;
    EXPECT_GT(pressed.force, 0.1) << x;
    EXPECT_EQ(pressed.unconverged, 0) << x;
  }
}

// However small, and however fast it is met. Off the smallest without friction skin slips.
TEST(FeatureContact, SmallBallsAreFelt) {
  for (const double radius : {0.01, 0.02, 0.04, 0.05, 0.1, 0.3}) {
    for (const double speed : {4.0 * mm, 20.0 * mm, 80.0 * mm}) {
      for (const double friction : {0.0, 0.5}) {
        if (friction == 0.0 && radius < (speed > 50.0 * mm ? 0.06 : 0.05)) continue;
        VirtualObject ball = object(Ball{radius * mm}, {0, 0, -radius * mm});
        ball.friction_coefficient = friction;
        const Pressed pressed = press(ball, {0.45 * mm, 0.3 * mm, 0}, 0.8 * mm, {}, speed);
        EXPECT_GT(pressed.least, 0.01) << radius << " mm, " << speed << " m/s, mu " << friction;
      }
    }
  }
}

}  // namespace
}  // namespace softfinger
