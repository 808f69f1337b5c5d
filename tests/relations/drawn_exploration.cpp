#include "drawn_exploration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "../geometry/generated_mesh.hpp"
#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/contact/deepest_point.hpp"
#include "softfinger/geometry/closed_surface.hpp"
#include "softfinger/geometry/grid_sampling.hpp"
#include "softfinger/geometry/triangle_tree.hpp"

namespace softfinger::relations {
namespace {

constexpr double kAbove = 1.0 * mm;  // the way down before the touch

Pose at(const Vector3& place, const Vector3& turn = Vector3::Zero()) {
  return {exp_rotation(turn), place};
}

/// Least distance of the skin, as its triangles have it, to the object, m.
double least_distance(const FingerModel& model, const Shape& shape, const Pose& X_OF) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& triangle : model.skin_triangles) {
    std::array<Vector3, 3> corners;
    double nearest = std::numeric_limits<double>::infinity();
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto sample = static_cast<std::size_t>(triangle[k]);
      corners[k] = X_OF * model.mesh.nodes[static_cast<std::size_t>(model.sample_nodes[sample])];
      nearest = std::min(nearest, signed_distance(shape, corners[k]).distance);
      longest = std::max(longest, (corners[k] - corners[0]).norm());
    }
    longest = std::max(longest, (corners[2] - corners[1]).norm());
    least = std::min(least, nearest);
    if (nearest - longest > least) continue;
    TrianglePoint point = least_of_few(shape, {}, corners);
    for (int descent = 0; descent < 40; ++descent) point = deepest_point(shape, {}, corners, point);
    least = std::min(least, point.gap);
  }
  return least;
}

const MeshShape& ball_of_triangles() {
  static const MeshShape shape = solid_of(sphere_mesh(12 * mm, 20));
  return shape;
}

template <typename T>
T nth(std::initializer_list<T> list, int number) {
  return list.begin()[static_cast<std::size_t>(number) % list.size()];
}

}  // namespace

MeshShape solid_of(TriangleMesh mesh) {
  const ClosedSurface surface = closed_surface(std::move(mesh), "mesh");
  const TriangleTree tree(surface);
  return std::make_shared<SignedDistanceGrid>(
      sample_distance(surface, tree, 0.4 * mm, 8.0 * mm, "mesh"), "mesh", 0);
}

std::shared_ptr<const FingerModel> draw_finger(Draw& draw, std::string& what) {
  constexpr std::array kNames{"index", "index", "thumb",         "middle",
                              "ring",  "pinky", "index-layered", "index-viscoelastic"};
  const char* name = kNames[static_cast<std::size_t>(draw.below(kNames.size()))];
  const auto file =
      std::filesystem::path(source_folder()) / "fingers" / (std::string(name) + ".toml");
  const FingerSize natural = finger_size(*FingerModel::load(file));
  const double length = draw.between(0.9, 1.1) * *natural.length;
  const double breadth = draw.between(0.9, 1.1) * *natural.breadth;
  const double depth = draw.between(0.9, 1.1) * *natural.depth;
  what +=
      fmt::format("{} of {:.2f} x {:.2f} x {:.2f} mm", name, length / mm, breadth / mm, depth / mm);
  return FingerModel::load(file, FingerSize{length, breadth, depth});
}

VirtualObject draw_object(Draw& draw, Thing thing, std::string& what) {
  VirtualObject object;
  object.name = "object";
  object.friction_coefficient = draw.chance(0.2) ? 0.0 : draw.between(0.1, 1.0);
  const double spin = draw.between(-3.0, 3.0);  // about the world's z, rad
  switch (thing) {
    case Thing::kPlane:
      object.shape = HalfSpace{};
      what += ", plane";
      break;
    case Thing::kBlock: {
      const Vector3 half(draw.between(15, 30) * mm, draw.between(15, 30) * mm,
                         draw.between(5, 20) * mm);
      object.shape = RoundedBox{half, draw.between(0.2, 2.0) * mm};
      object.motion = Trajectory(at({0.0, 0.0, -half.z()}, {0.0, 0.0, spin}));
      what += ", block";
      break;
    }
    case Thing::kBall: {
      const double radius = draw.between(4, 40) * mm;
      object.shape = Ball{radius};
      object.motion = Trajectory(at({0.0, 0.0, -radius}));
      what += fmt::format(", ball of {:.2f} mm", radius / mm);
      break;
    }
    case Thing::kCylinder: {
      const double radius = draw.between(3, 20) * mm;
      object.shape = RoundedCylinder{radius, 40 * mm, 0.5 * mm};
      // Its axis lies along x, then turned about z.
      const Matrix3 lying = exp_rotation({0.0, 90 * deg, 0.0});
      object.motion =
          Trajectory(Pose{exp_rotation({0.0, 0.0, spin}) * lying, Vector3(0.0, 0.0, -radius)});
      what += fmt::format(", cylinder of {:.2f} mm", radius / mm);
      break;
    }
    case Thing::kMesh:
      object.shape = ball_of_triangles();
      object.motion =
          Trajectory(at({0.0, 0.0, -12 * mm}, draw.between(0.0, 3.0) * draw.direction()));
      what += ", ball of triangles";
      break;
    case Thing::kEdge: {
      const double rounding = draw.between(0.3, 2.0) * mm;
      object.shape = RoundedBox{Vector3(20, 20, 20) * mm, rounding};
      const double shift = draw.between(-3.0, 3.0) * mm;
      object.motion =
          Trajectory(at(exp_rotation({0.0, 0.0, spin}) * Vector3(-20 * mm + shift, 0.0, -20 * mm),
                        {0.0, 0.0, spin}));
      what += fmt::format(", edge of {:.2f} mm", rounding / mm);
      break;
    }
    case Thing::kPlate: {
      const double thickness = draw.between(0.1, 0.6) * mm;
      object.shape = RoundedBox{Vector3(30 * mm, 30 * mm, 0.5 * thickness), 0.0};
      object.motion = Trajectory(at({0.0, 0.0, -0.5 * thickness}, {0.0, 0.0, spin}));
      what += fmt::format(", plate of {:.3f} mm", thickness / mm);
      break;
    }
    case Thing::kBead: {
      const double radius = std::exp(draw.between(std::log(0.05), std::log(1.0))) * mm;
      object.shape = Ball{radius};
      object.motion = Trajectory(at({0.0, 0.0, -radius}));
      what += fmt::format(", bead of {:.3f} mm", radius / mm);
      break;
    }
  }
  what += fmt::format(", friction {:.3f}", *object.friction_coefficient);
  return object;
}

Pose touching(const FingerModel& model, const VirtualObject& object, const Matrix3& turn) {
  const Pose X_OW = object.motion.sample(0.0).inverse();
  Pose X_WFt{turn, Vector3(0.0, 0.0, 40 * mm)};
  // Distances bound how far down nothing touches.
  for (int look = 0; look < 400; ++look) {
    const double least = least_distance(model, object.shape, X_OW * X_WFt);
    if (least < 1e-7) break;
    X_WFt.translation.z() -= 0.98 * least;
  }
  return X_WFt;
}

Exploration draw_exploration(Draw& draw, int number, std::initializer_list<Thing> things,
                             std::initializer_list<Path> paths) {
  Exploration drawn;
  drawn.what = fmt::format("case {}: ", number);
  drawn.model = draw_finger(draw, drawn.what);
  const Thing thing = nth(things, number);
  // Which paths meet which things changes from round to round.
  const Path path = nth(paths, number + number / static_cast<int>(things.size()));
  drawn.objects.push_back(draw_object(draw, thing, drawn.what));
  const Matrix3 turn = exp_rotation({0.0, draw.between(0.0, 20.0) * deg, 0.0}) *
                       exp_rotation({draw.between(-8.0, 8.0) * deg, 0.0, 0.0}) *
                       exp_rotation({0.0, 0.0, draw.between(-20.0, 20.0) * deg});
  const Pose touch = touching(*drawn.model, drawn.objects.front(), turn);
  const double depth = draw.between(0.7, 1.6) * mm;
  const double speed = draw.between(20.0, 80.0) * mm;  // a second, on the way down
  std::vector<Waypoint> waypoints;
  double time = 0.0;
  const auto go = [&](const Pose& pose, double duration) {
    time += duration;
    waypoints.push_back({time, pose});
  };
  const auto lifted = [&](const Pose& pose, double by) {
    Pose result = pose;
    result.translation.z() += by;
    return result;
  };
  const Pose pressed = lifted(touch, -depth);
  go(lifted(touch, kAbove), 0.0);
  switch (path) {
    case Path::kTap:
      go(pressed, (kAbove + depth) / (3.0 * speed));
      go(pressed, 0.03);
      go(lifted(touch, kAbove), (kAbove + depth) / (3.0 * speed));
      go(lifted(touch, kAbove), 0.05);
      drawn.what += fmt::format(", tap at {:.0f} mm/s", 3.0 * speed / mm);
      break;
    case Path::kPress:
      go(pressed, (kAbove + depth) / speed);
      go(pressed, 0.25);
      drawn.what += ", press";
      break;
    case Path::kSlide: {
      const double heading = draw.between(-3.1, 3.1);
      const double way = draw.between(1.0, 5.0) * mm;
      const double stroke = draw.between(20.0, 100.0) * mm;  // a second
      Pose there = pressed;
      there.translation += way * Vector3(std::cos(heading), std::sin(heading), 0.0);
      go(pressed, (kAbove + depth) / speed);
      go(pressed, 0.05);
      go(there, way / stroke);
      go(there, 0.1);
      drawn.what += fmt::format(", slide at {:.0f} mm/s", stroke / mm);
      break;
    }
    case Path::kRoll: {
      const Vector3 axis = draw.chance(0.5) ? Vector3::UnitX() : Vector3::UnitY();
      const double angle = draw.between(5.0, 15.0) * deg * (draw.chance(0.5) ? 1.0 : -1.0);
      const double rate = draw.between(40.0, 150.0) * deg;  // a second
      Pose there = pressed;
      there.rotation = there.rotation * exp_rotation(angle * axis);
      go(pressed, (kAbove + depth) / speed);
      go(pressed, 0.05);
      go(there, std::abs(angle) / rate);
      go(there, 0.1);
      drawn.what += fmt::format(", roll at {:.0f} deg/s", rate / deg);
      break;
    }
  }
  drawn.what += fmt::format(" {:.2f} mm deep", depth / mm);
  drawn.motion = Trajectory(std::move(waypoints));
  return drawn;
}

}  // namespace softfinger::relations
