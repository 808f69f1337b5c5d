// A finger drawn over a plane, and devices that make the wearer feel it: tangential forces of the
// twin against those of the virtual contact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "project.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/twin/skin_comparison.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

constexpr double kShearStep = 1e-3;  // s
constexpr int kShearTick = 33;       // steps
constexpr double kRoughness = 0.5;

std::shared_ptr<const FingerModel> index_held_tightly() {
  auto model =
      std::make_shared<FingerModel>(*FingerModel::load(kProject / "fingers" / "index.toml"));
  model->coupling = {1e5, 100.0, 20.0, 0.02};
  return model;
}

/// Where the bone is pressed to and drawn: `aside` mm along `way` and back by twice that, at
/// 12 mm/s, after 0.4 s of pressing.
Vector3 drawn_by(double time, double aside, const Vector3& way) {
  const double gone = std::max(0.0, time - 0.4) * 12.0;  // mm
  const double place = gone < aside ? gone : std::max(2.0 * aside - gone, -aside);
  return place * mm * way;
}

using Rendered = std::function<Configuration(const FingerSimulation&, double elapsed)>;

/// Mean measures of a device that goes where `rendered` says at each tick, while the finger is
/// pressed by 1 mm and drawn.
RenderingMeasures drawn_over_plane(const std::shared_ptr<const Device>& device, double aside,
                                   const Vector3& way, const Rendered& rendered,
                                   double friction = kRoughness) {
  static const auto model = index_held_tightly();
  VirtualObject plane;
  plane.name = "plane";
  plane.motion = Trajectory({Waypoint{}});
  plane.friction_coefficient = friction;
  FingerSimulation simulation(model, {&plane, 1}, kShearStep);
  double lowest = 0.0;
  for (const Vector3& p : model->mesh.nodes) lowest = std::min(lowest, p.z());
  Pose X_WFt{Matrix3::Identity(), Vector3(0.0, 0.0, -lowest + 0.5 * mm)};
  simulation.reset(X_WFt);
  Twin twin(model, device);
  SkinComparison comparison(model, model, SkinComparison::Depth::kSkin);
  MeasureMeans means;
  const double elapsed = kShearTick * kShearStep;
  const int steps = static_cast<int>((0.4 + 3.0 * aside / 12.0) / kShearStep);
  for (int step = 1; step <= steps; ++step) {
    const double time = step * kShearStep;
    X_WFt.translation = drawn_by(time, aside, way);
    X_WFt.translation.z() = -lowest + std::max(-1.0 * mm, 0.5 * mm - 5.0 * mm * time);
    simulation.step(X_WFt, time);
    if (step % kShearTick != 0) continue;
    twin.press(rendered(simulation, elapsed), friction, elapsed);
    if (time > 0.4) {
      comparison.take_virtual(simulation.contact(), {});
      means.add(comparison.compare(twin.contact(), {}));
    }
  }
  return means.mean();
}

/// A wide disk that three drives move: as good as the plane itself.
std::shared_ptr<const Device> plane_on_drives() {
  static const auto device = load_device(
      "plane.toml",
      "kind = \"linear_drives\"\n[mount]\ntranslation_mm = [0.0, 0.0, -20.0]\n"
      "[[drive]]\nname = \"x_mm\"\naxis = [1.0, 0.0, 0.0]\njoint_mm = [-40.0, 40.0]\n"
      "[[drive]]\nname = \"y_mm\"\naxis = [0.0, 1.0, 0.0]\njoint_mm = [-40.0, 40.0]\n"
      "[[drive]]\nname = \"travel_mm\"\naxis = [0.0, 0.0, 1.0]\njoint_mm = [-5.0, 20.0]\n"
      "[[surface]]\ntype = \"disk\"\nradius_mm = 60.0\n[limits]\njoint_rate_mm_per_s = 1000.0\n",
      0.0);
  return device;
}

/// Where the plane is, seen from the bone; `part` of the way along it.
Configuration with_the_plane(const FingerSimulation& simulation, double part) {
  const Vector3 p = -simulation.bone_pose().translation;
  Configuration q(3);
  q << part * p.x(), part * p.y(), p.z() + 20.0 * mm;
  return q;
}

const std::vector<Vector3> kWays{Vector3::UnitX(), -Vector3::UnitY(), Vector3(0.6, 0.8, 0.0)};

// What the comparison must say of the best device there can be: nothing is amiss, while it sticks,
// slides and turns back, although the twin knows nothing but the device's own way.
TEST(Shear, ADeviceThatGoesWithTheObjectFeelsAsItDoes) {
  for (const double aside : {0.5, 4.0}) {
    for (const Vector3& way : kWays) {
      const RenderingMeasures mean = drawn_over_plane(
          plane_on_drives(), aside, way, [](const FingerSimulation& simulation, double) {
            return with_the_plane(simulation, 1.0);
          });
      EXPECT_LT(mean.normal_force_error, 0.01);
      EXPECT_LT(mean.tangential_force_error, 0.02) << aside << " mm along " << way.transpose();
      EXPECT_LT(mean.slip_ratio_error, 0.04);
    }
  }
}

TEST(Shear, ADeviceThatStaysLacksAllOfItAndOneThatGoesTheOtherWayTwice) {
  for (const Vector3& way : kWays) {
    const auto error = [&](double part) {
      return drawn_over_plane(plane_on_drives(), 4.0, way,
                              [&](const FingerSimulation& simulation, double) {
                                return with_the_plane(simulation, part);
                              })
          .tangential_force_error;
    };
    const double staying = error(0.0);
    EXPECT_GT(staying, 0.7 * kRoughness);
    EXPECT_LT(staying, kRoughness + 0.05);
    EXPECT_NEAR(error(-1.0), 2.0 * staying, 0.3 * staying);
  }
}

TEST(Shear, NothingIsAmissWithoutFriction) {
  const RenderingMeasures mean = drawn_over_plane(
      plane_on_drives(), 2.0, Vector3::UnitX(),
      [](const FingerSimulation& simulation, double) { return with_the_plane(simulation, 0.0); },
      0.0);
  EXPECT_LT(mean.tangential_force_error, 1e-9);
  EXPECT_EQ(mean.slip_ratio_error, 0.0);
}

/// As drawn_over_plane() where an objective leads a shipped device.
RenderingMeasures led_over_plane(const std::string& name, const char* objective_name,
                                 const Vector3& way) {
  const auto device = load_device(kProject / "devices" / (name + ".toml"));
  static const auto model = index_held_tightly();
  const auto objective = objective_kind(objective_name)->make(model, device);
  std::vector<Vector3> nodes;
  return drawn_over_plane(
      device, 2.0, way, [&](const FingerSimulation& simulation, double elapsed) {
        nodes.assign(simulation.positions().begin(), simulation.positions().end());
        const Configuration q =
            objective->tick({simulation.contact(), nodes, simulation.bone_pose()}, elapsed)
                .configuration;
        objective->follow(q);
        return q;
      });
}

struct ShearDevice {
  const char* name;
  Vector3 way;   ///< along which it can shear
  double error;  ///< at most this part of the thimble's
};
void PrintTo(const ShearDevice& device, std::ostream* out) { *out << device.name; }

class ShearOf : public testing::TestWithParam<ShearDevice> {};

TEST_P(ShearOf, IsNearerThanThatOfTheThimble) {
  const auto& [name, way, part] = GetParam();
  const RenderingMeasures thimble = led_over_plane("thimble-3rrs", "surface_and_force", way);
  const RenderingMeasures sheared = led_over_plane(name, "surface_and_force", way);
  EXPECT_GT(thimble.tangential_force_error, 0.5 * kRoughness);
  EXPECT_LT(sheared.tangential_force_error, part * thimble.tangential_force_error);
  EXPECT_LT(sheared.slip_ratio_error, thimble.slip_ratio_error);
  EXPECT_LT(sheared.normal_force_error, 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    Devices, ShearOf,
    testing::Values(ShearDevice{"plate-6dof", Vector3(0.6, 0.8, 0.0), 0.1},
                    ShearDevice{"delta-schorr", Vector3(0.6, 0.8, 0.0), 0.65},
                    ShearDevice{"five-bar", Vector3::UnitX(), 0.5},
                    ShearDevice{"shear-tactor-gleeson", Vector3(0.6, 0.8, 0.0), 0.4},
                    ShearDevice{"strap-minamizawa", Vector3::UnitY(), 0.7},
                    ShearDevice{"slip-ball-webster", Vector3(0.6, 0.8, 0.0), 0.3},
                    ShearDevice{"slip-wheel-salada", Vector3::UnitX(), 0.4},
                    ShearDevice{"lateral-pins-pasquero", Vector3::UnitX(), 0.8}),
    [](const auto& device) {
      std::string name = device.param.name;
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace softfinger
