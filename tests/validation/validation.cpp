// Checks of the library that no command shows, as one JSON object; tools/validate judges them.

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "../support/free_flight.hpp"
#include "elastic_checks.hpp"
#include "hertz.hpp"
#include "motion_checks.hpp"
#ifdef SOFTFINGER_MUJOCO
#include "mujoco_checks.hpp"
#endif
#include "softfinger/base/units.hpp"

namespace {

using Json = nlohmann::ordered_json;
using namespace softfinger;

Json patch_json() {
  Json rows = Json::array();
  for (const validation::PatchTest& t : validation::patch_tests()) {
    rows.push_back({{"tetrahedra", t.tetrahedra},
                    {"free_nodes", t.free_nodes},
                    {"strain", t.strain},
                    {"error_mm", t.error / mm}});
  }
  return rows;
}

Json invariance_json() {
  const validation::Invariance i = validation::invariance();
  return {{"energy", i.energy},
          {"forces", i.forces},
          {"net_force", i.net_force},
          {"net_torque", i.net_torque},
          {"gradient", i.gradient}};
}

Json cantilever_json() {
  Json rows = Json::array();
  for (const validation::Cantilever& c : validation::cantilevers()) {
    rows.push_back({{"poissons_ratio", c.poissons_ratio},
                    {"elements_over_height", c.elements_over_height},
                    {"tetrahedra", c.tetrahedra},
                    {"deflection", c.deflection}});
  }
  return rows;
}

Json hertz_json() {
  Json presses = Json::array();
  for (const validation::HertzPress& press : validation::hertz_presses()) {
    Json rows = Json::array();
    for (const validation::HertzRow& row : press.rows) {
      rows.push_back({{"indentation_mm", row.depth / mm},
                      {"force_N", row.force},
                      {"radius_mm", row.radius / mm},
                      {"hertz_force_N", row.hertz_force}});
    }
    presses.push_back({{"tetrahedra", press.tetrahedra},
                       {"cells", press.cells},
                       {"grading", press.grading},
                       {"element_size_mm", press.element_size / mm},
                       {"rows", rows}});
  }
  return presses;
}

Json free_flight_json() {
  Json rows = Json::array();
  for (const double time_step : {0.1e-3, 1e-3, 16e-3}) {
    testing_support::FreeFlight flight(time_step);
    bool converged = flight.step();
    const Vector3 momentum = flight.momentum();
    double energy = flight.energy();
    double drift = 0.0, gain = -1.0;
    Json energies = Json::array();
    for (int k = 0; k < 300; ++k) {
      converged = flight.step() && converged;
      const double now = flight.energy();
      drift = std::max(drift, (flight.momentum() - momentum).norm() / momentum.norm());
      gain = std::max(gain, now / energy - 1.0);
      energy = now;
      energies.push_back(now);
    }
    rows.push_back({{"time_step_ms", time_step / ms},
                    {"converged", converged},
                    {"momentum", momentum.norm()},
                    {"momentum_drift", drift},
                    {"largest_energy_gain", gain},
                    {"energy_J", energies}});
  }
  return rows;
}

Json to_json(const validation::Drift& drift) {
  return {{"force_N", drift.force}, {"drift_m", drift.drift}};
}

Json to_json(const validation::Incline& incline) {
  return {{"angle_error_deg", incline.angle_error / deg},
          {"acceleration_error", incline.acceleration_error},
          {"creep_m_per_s", incline.creep}};
}

Json motion_json() {
  const validation::MotionFigures f = validation::motion_figures();
  const validation::Drift held = validation::held_capsule({}, false);
  Json json{{"held", to_json(held)},
            {"shaken", to_json(validation::held_capsule({}, true))},
            {"incline", to_json(validation::incline())},
            {"hold_margin", f.hold_margin},
            {"momentum_error", f.momentum_error},
            {"pendulum_lost", f.pendulum_lost},
            {"energy_gained_J", f.energy_gained},
            {"energy_lost_J", f.energy_lost},
            {"rest_penetration_m", f.rest_penetration},
            {"button_force_N", f.button_force},
            {"button_travel_mm", f.button_travel / mm},
            {"stiff_soft_force", f.stiff_soft_force},
            {"unconverged", f.unconverged},
            {"steps", f.steps},
            {"mujoco", nullptr}};
#ifdef SOFTFINGER_MUJOCO
  using validation::MujocoContact;
  Json rows = Json::array();
  for (const auto& [name, contact] : {std::pair{"defaults", MujocoContact::kUsual},
                                      std::pair{"impratio 100", MujocoContact::kStiffFriction},
                                      std::pair{"20 noslip passes", MujocoContact::kNoslip}}) {
    rows.push_back({{"name", name},
                    {"held", to_json(validation::mujoco_held_capsule({}, held.force, contact))},
                    {"incline", to_json(validation::mujoco_incline(contact))}});
  }
  json["mujoco"] = {{"version", validation::mujoco_version()}, {"contacts", rows}};
#endif
  return json;
}

}  // namespace

int main() {
  const Json all{{"patch", patch_json()},
                 {"invariance", invariance_json()},
                 {"cantilever", cantilever_json()},
                 {"hertz", hertz_json()},
                 {"free_flight", free_flight_json()},
                 {"motion", motion_json()}};
  fmt::print("{}\n", all.dump());
}
