#include "hertz.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../support/box_mesh.hpp"
#include "softfinger/identification/indentation.hpp"

namespace softfinger::validation {
namespace {

constexpr double kRadius = 10e-3;
constexpr double kModulus = 45e3;
constexpr double kPoissonsRatio = 0.3;
constexpr double kGrading = 1.4;

/// From the half cube |x|, |y| <= 1, -1 <= z <= 0 to the half ball: graded to the pole, then by the
/// elliptical map x sqrt(1 - y^2/2 - z^2/2 + y^2 z^2/3), which turns no element over.
Vector3 in_ball(const Vector3& cube) {
  const auto graded = [](double t) { return std::copysign(std::pow(std::abs(t), kGrading), t); };
  const Vector3 p(graded(cube.x()), graded(cube.y()), graded(1.0 + cube.z()) - 1.0);
  const Vector3 s = p.cwiseProduct(p);
  const auto scale = [](double a, double b) {
    return std::sqrt(std::max(0.0, 1.0 - 0.5 * (a + b) + a * b / 3.0));
  };
  return kRadius *
         p.cwiseProduct(Vector3(scale(s.y(), s.z()), scale(s.z(), s.x()), scale(s.x(), s.y())));
}

FingerModel half_ball(int n) {
  FingerModel model;
  model.mesh = testing_support::box_mesh(n, n, n / 2, Vector3(-1, -1, -1), Vector3(2, 2, 1));
  std::vector<bool> on_surface, on_equator;
  for (Vector3& node : model.mesh.nodes) {
    on_surface.push_back(node.head<2>().cwiseAbs().maxCoeff() > 1.0 - 1e-9 ||
                         node.z() < -1.0 + 1e-9);
    on_equator.push_back(node.z() > -1e-9);
    node = in_ball(node);
  }
  model.node_is_rigid = on_equator;
  model.tetrahedron_material.assign(model.mesh.tetrahedra.size(), 0);
  model.materials = {{{kModulus, kPoissonsRatio, 1000.0}, "rubber"}};
  model.contact_tolerance = 5e-6;
  std::vector<int> sample_of(model.mesh.nodes.size(), -1);
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    if (model.mesh.triangle_surface[t] != 0) continue;
    std::array<int, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const int node = model.mesh.triangles[t][k];
      int& sample = sample_of[static_cast<std::size_t>(node)];
      if (sample < 0) {
        sample = static_cast<int>(model.sample_nodes.size());
        model.sample_nodes.push_back(node);
      }
      triangle[k] = sample;
    }
    model.skin_triangles.push_back(triangle);
  }
  model.measure();
  return model;
}

}  // namespace

std::vector<HertzPress> hertz_presses() {
  std::vector<HertzPress> presses;
  for (const int n : {8, 12, 16, 22}) {
    const FingerModel model = half_ball(n);
    HertzPress press;
    press.tetrahedra = static_cast<int>(model.mesh.tetrahedra.size());
    press.cells = n;
    press.grading = kGrading;
    press.element_size = kRadius * std::pow(2.0 / n, kGrading);
    IndentationOptions options;
    options.depth = 1e-3;
    options.rows = 20;
    options.friction = false;
    options.strain_limits = false;
    indent(model, Indenter::plane(), options, [&](const IndentationState& state) {
      const double d = state.row.indentation;
      const double effective = kModulus / (1.0 - kPoissonsRatio * kPoissonsRatio);
      press.rows.push_back({d, state.row.normal_force,
                            std::sqrt(state.row.contact_area / std::numbers::pi),
                            4.0 / 3.0 * effective * std::sqrt(kRadius) * std::pow(d, 1.5)});
    });
    presses.push_back(std::move(press));
  }
  return presses;
}

}  // namespace softfinger::validation
