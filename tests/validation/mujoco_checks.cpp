#include "mujoco_checks.hpp"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <stdexcept>

namespace softfinger::validation {
namespace {

constexpr double kGravity = 9.81;
constexpr double kDegree = std::numbers::pi / 180.0;

/// A model in MJCF, stepped once a millisecond, as ours.
class MujocoWorld {
 public:
  explicit MujocoWorld(const std::string& xml) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "model.xml", static_cast<int>(xml.size()));
    std::memcpy(files->filedata[mj_findFileVFS(files.get(), "model.xml")], xml.data(), xml.size());
    std::array<char, 1000> error{};
    model_.reset(mj_loadXML("model.xml", files.get(), error.data(), error.size()));
    mj_deleteVFS(files.get());
    if (!model_) throw std::runtime_error(error.data());
    data_.reset(mj_makeData(model_.get()));
  }
  void run(double duration) {
    const auto steps = std::lround(duration / model_->opt.timestep);
    for (long k = 0; k < steps; ++k) mj_step(model_.get(), data_.get());
  }
  [[nodiscard]] mjData& data() { return *data_; }
  /// m, of the body's centre.
  [[nodiscard]] std::array<double, 3> place(const char* body) const {
    const int id = mj_name2id(model_.get(), mjOBJ_BODY, body);
    const mjtNum* at = data_->xpos + 3 * id;
    return {at[0], at[1], at[2]};
  }

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
};

std::string option(MujocoContact contact, const std::array<double, 3>& gravity) {
  return fmt::format(
      R"(<option timestep="0.001" gravity="{} {} {}" cone="elliptic" impratio="{}" noslip_iterations="{}"/>)",
      gravity[0], gravity[1], gravity[2], contact == MujocoContact::kStiffFriction ? 100 : 1,
      contact == MujocoContact::kNoslip ? 20 : 0);
}

MujocoWorld block_on_slope(double angle, double friction, MujocoContact contact) {
  return MujocoWorld(fmt::format(
      R"(<mujoco>{}<worldbody><geom type="plane" size="5 5 1" friction="{} 0.005 0.0001"/>)"
      R"(<body name="block" pos="0 0 0.005"><freejoint/><geom type="box" size="0.02 0.02 0.005" )"
      R"(mass="0.05" friction="{} 0.005 0.0001"/></body></worldbody></mujoco>)",
      option(contact, {kGravity * std::sin(angle), 0.0, -kGravity * std::cos(angle)}), friction,
      friction));
}

}  // namespace

std::string mujoco_version() { return mj_versionString(); }

Drift mujoco_held_capsule(const HeldCapsule& capsule, double force, MujocoContact contact) {
  const auto finger = [&](const char* name, double sign) {
    return fmt::format(
        R"(<body name="{0}" pos="{1} 0 0.1"><joint name="{0}" type="slide" axis="1 0 0" )"
        R"(damping="1"/><geom type="sphere" size="0.008" mass="0.02" condim="4" )"
        R"(friction="{2} 0.005 0.0001"/></body>)",
        name, sign * (capsule.radius + 0.008), capsule.friction);
  };
  MujocoWorld world(fmt::format(
      R"(<mujoco>{}<worldbody>{}{}<body name="capsule" pos="0 0 0.1"><freejoint/>)"
      R"(<geom type="capsule" size="{} {}" mass="{}" condim="4" friction="{} 0.005 0.0001"/></body>)"
      R"(</worldbody><actuator><motor joint="right"/><motor joint="left"/></actuator></mujoco>)",
      option(contact, {0.0, 0.0, -kGravity}), finger("right", 1.0), finger("left", -1.0),
      capsule.radius, capsule.half_length - capsule.radius, capsule.mass, capsule.friction));
  world.data().ctrl[0] = -force;
  world.data().ctrl[1] = force;
  world.run(1.5);
  const std::array<double, 3> settled = world.place("capsule");
  Drift found;
  found.force = force;
  for (int second = 1; second <= static_cast<int>(capsule.duration); ++second) {
    world.run(1.0);
    const std::array<double, 3> now = world.place("capsule");
    found.drift.push_back(
        std::hypot(now[0] - settled[0], now[1] - settled[1], now[2] - settled[2]));
  }
  return found;
}

Incline mujoco_incline(MujocoContact contact) {
  Incline found;
  const double critical = std::atan(found.friction);
  // It creeps on every slope: by acceleration alone can sliding be told.
  const auto slides = [&](double angle) {
    MujocoWorld world = block_on_slope(angle, found.friction, contact);
    world.run(0.5);
    const double speed = world.data().qvel[0];
    world.run(1.0);
    return world.data().qvel[0] - speed > 1e-3;
  };
  double sticks = critical - 3.0 * kDegree;
  double slips = critical + 3.0 * kDegree;
  while (slips - sticks > 0.01 * kDegree) {
    const double middle = 0.5 * (sticks + slips);
    (slides(middle) ? slips : sticks) = middle;
  }
  found.angle_error = 0.5 * (sticks + slips) - critical;
  const double steep = critical + 2.0 * kDegree;
  MujocoWorld fast = block_on_slope(steep, found.friction, contact);
  fast.run(0.5);
  const double speed = fast.data().qvel[0];
  fast.run(1.0);
  const double wanted = kGravity * (std::sin(steep) - found.friction * std::cos(steep));
  found.acceleration_error = (fast.data().qvel[0] - speed) / wanted - 1.0;
  MujocoWorld slow = block_on_slope(critical - 0.5 * kDegree, found.friction, contact);
  slow.run(0.5);
  const double start = slow.place("block")[0];
  slow.run(10.0);
  found.creep = (slow.place("block")[0] - start) / 10.0;
  return found;
}

}  // namespace softfinger::validation
