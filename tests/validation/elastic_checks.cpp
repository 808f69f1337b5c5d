#include "elastic_checks.hpp"

#include <algorithm>
#include <cmath>

#include "../support/box_mesh.hpp"
#include "softfinger/fem/elastic_model.hpp"

namespace softfinger::validation {
namespace {

using testing_support::box_mesh;
using testing_support::displace;
using Positions = std::vector<Vector3>;

constexpr double kModulus = 45e3;

ElasticModel solid(const TetrahedralMesh& mesh, double poissons_ratio, const StrainLimit& limit) {
  const ElasticMaterial material{kModulus, poissons_ratio, 1000.0};
  const std::vector<int> element_material(mesh.tetrahedra.size(), 0);
  const std::vector<bool> tied(mesh.nodes.size(), false);
  return {mesh, {&material, 1},          element_material, tied, limit, Dilatation::kElement,
          {},   active_instruction_set()};
}

/// Equilibrium of some nodes under given forces, from gradients alone: Newton's method whose linear
/// systems conjugate gradients solve, with central differences of the gradient as the product.
class Equilibrium {
 public:
  Equilibrium(const ElasticModel& model, std::vector<bool> is_free)
      : model_(model), work_(model.make_work()), is_free_(std::move(is_free)) {}

  void solve(Positions& x, const Positions& load, int newton_steps) {
    for (int k = 0; k < newton_steps; ++k) {
      Positions right = gradient(x);
      for (std::size_t n = 0; n < x.size(); ++n) right[n] = load[n] - right[n];
      mask(right);
      const Positions step = conjugate_gradients(x, right);
      for (std::size_t n = 0; n < x.size(); ++n) x[n] += step[n];
    }
  }

 private:
  Positions gradient(const Positions& x) {
    Positions g(x.size(), Vector3::Zero());
    model_.energy_gradient(x, work_, g);
    return g;
  }
  void mask(Positions& v) const {
    for (std::size_t n = 0; n < v.size(); ++n) {
      if (!is_free_[n]) v[n].setZero();
    }
  }
  static double dot(const Positions& a, const Positions& b) {
    double sum = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n) sum += a[n].dot(b[n]);
    return sum;
  }
  Positions product(const Positions& x, const Positions& p) {
    double largest = 0.0;
    for (const Vector3& v : p) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    const double h = 1e-8 / largest;
    Positions above = x, below = x;
    for (std::size_t n = 0; n < x.size(); ++n) {
      above[n] += h * p[n];
      below[n] -= h * p[n];
    }
    Positions result = gradient(above);
    const Positions lower = gradient(below);
    for (std::size_t n = 0; n < x.size(); ++n) result[n] = (result[n] - lower[n]) / (2.0 * h);
    mask(result);
    return result;
  }
  Positions conjugate_gradients(const Positions& x, Positions residual) {
    Positions step(x.size(), Vector3::Zero());
    Positions p = residual;
    double squares = dot(residual, residual);
    const double enough = 1e-14 * squares;
    for (int k = 0; k < 5000 && squares > enough; ++k) {
      const Positions q = product(x, p);
      const double t = squares / dot(p, q);
      for (std::size_t n = 0; n < x.size(); ++n) {
        step[n] += t * p[n];
        residual[n] -= t * q[n];
      }
      const double next = dot(residual, residual);
      for (std::size_t n = 0; n < x.size(); ++n) p[n] = residual[n] + next / squares * p[n];
      squares = next;
    }
    return step;
  }

  const ElasticModel& model_;
  ElasticModel::Work work_;
  std::vector<bool> is_free_;
};

double largest(const Positions& v) {
  double norm = 0.0;
  for (const Vector3& x : v) norm = std::max(norm, x.norm());
  return norm;
}

}  // namespace

std::vector<PatchTest> patch_tests() {
  std::vector<PatchTest> results;
  for (const int n : {4, 8}) {
    for (const double strain : {0.01, 0.2}) {
      TetrahedralMesh mesh = box_mesh(n, n, n, Vector3::Constant(-5e-3), Vector3::Constant(10e-3));
      std::vector<bool> is_free(mesh.nodes.size());
      for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        is_free[i] = mesh.nodes[i].cwiseAbs().maxCoeff() < 4.99e-3;
      }
      // The interior nodes lie irregularly: on a regular mesh symmetry alone would pass the test.
      Positions shift(mesh.nodes.size(), Vector3::Zero());
      displace(shift, 0.15 * 10e-3 / n, 5);
      for (std::size_t i = 0; i < shift.size(); ++i) {
        if (is_free[i]) mesh.nodes[i] += shift[i];
      }
      const ElasticModel model = solid(mesh, 0.4, {0.0, 0.0, 0.0, 1.0});
      Matrix3 stretch = Matrix3::Identity();
      stretch(0, 0) += strain;
      stretch(1, 1) -= 0.5 * strain;
      stretch(0, 2) += 0.5 * strain;
      const Matrix3 affine = exp_rotation(Vector3(0.4, -0.7, 0.3)) * stretch;
      Positions x;
      for (const Vector3& X : mesh.nodes) x.push_back(affine * X);
      const Positions exact = x;
      displace(shift, 0.02 * 10e-3 / n, 6);
      for (std::size_t i = 0; i < x.size(); ++i) {
        if (is_free[i]) x[i] += shift[i];
      }
      Equilibrium(model, is_free).solve(x, Positions(x.size(), Vector3::Zero()), 6);
      double error = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double own = (x[i] - exact[i]).norm();
        if (!(own <= error)) error = own;  // what is not a number too
      }
      results.push_back({static_cast<int>(mesh.tetrahedra.size()),
                         static_cast<int>(std::ranges::count(is_free, true)), strain, error});
    }
  }
  return results;
}

Invariance invariance() {
  const TetrahedralMesh mesh =
      box_mesh(6, 5, 4, Vector3(-6, -5, -4) * 1e-3, Vector3(12, 10, 8) * 1e-3);
  const ElasticModel model = solid(mesh, 0.4, {0.35, 1.5, 80e3, 0.5});
  Positions x = mesh.nodes;
  for (Vector3& p : x) p.z() *= 0.8;
  displace(x, 0.3e-3, 9);
  ElasticModel::Work work = model.make_work();
  const auto evaluate = [&](const Positions& at, Positions& g) {
    g.assign(at.size(), Vector3::Zero());
    return model.energy_gradient(at, work, g);
  };
  Positions g, turned_g;
  const double energy = evaluate(x, g);
  const Matrix3 turn = exp_rotation(Vector3(1.1, -0.6, 2.0));
  Positions turned;
  for (const Vector3& p : x) turned.push_back(turn * p + Vector3(0.03, -0.02, 0.05));
  const double turned_energy = evaluate(turned, turned_g);

  Invariance result;
  const double scale = largest(g);
  result.energy = std::abs(turned_energy - energy) / energy;
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  for (std::size_t n = 0; n < x.size(); ++n) {
    result.forces = std::max(result.forces, (turned_g[n] - turn * g[n]).norm() / scale);
    force += g[n];
    torque += x[n].cross(g[n]);
  }
  result.net_force = force.norm() / scale;
  result.net_torque = torque.norm() / (scale * 12e-3);
  Positions unused;
  constexpr double kStep = 1e-8;  // m
  for (std::size_t n = 0; n < x.size(); n += 7) {
    for (int k = 0; k < 3; ++k) {
      Positions moved = x;
      moved[n][k] += kStep;
      const double above = evaluate(moved, unused);
      moved[n][k] -= 2.0 * kStep;
      const double below = evaluate(moved, unused);
      const double difference = (above - below) / (2.0 * kStep);
      result.gradient = std::max(result.gradient, std::abs(difference - g[n][k]) / scale);
    }
  }
  return result;
}

std::vector<Cantilever> cantilevers() {
  constexpr double kHeight = 1e-3, kLength = 10e-3;
  std::vector<Cantilever> results;
  for (const double nu : {0.0001, 0.3}) {
    for (const int n : {1, 2, 4, 8}) {
      const TetrahedralMesh mesh = box_mesh(10 * n, n, n, Vector3(0, -0.5, -0.5) * kHeight,
                                            Vector3(kLength, kHeight, kHeight));
      const ElasticModel model = solid(mesh, nu, {0.0, 0.0, 0.0, 1.0});
      // Small enough for beam theory: the tip sinks by about 1e-4 of the length.
      const double inertia = std::pow(kHeight, 4) / 12.0;
      const double force = 1e-4 * kLength * 3.0 * kModulus * inertia / std::pow(kLength, 3);
      const double shear_modulus = kModulus / (2.0 * (1.0 + nu));
      const double beam = force * std::pow(kLength, 3) / (3.0 * kModulus * inertia) +
                          force * kLength / (5.0 / 6.0 * shear_modulus * kHeight * kHeight);
      std::vector<bool> is_free(mesh.nodes.size());
      Positions load(mesh.nodes.size(), Vector3::Zero());
      double at_tip = 0.0;
      for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        is_free[i] = mesh.nodes[i].x() > 1e-9;
        at_tip += mesh.nodes[i].x() > kLength - 1e-9 ? 1.0 : 0.0;
      }
      for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        if (mesh.nodes[i].x() > kLength - 1e-9) load[i].z() = -force / at_tip;
      }
      Positions x = mesh.nodes;
      Equilibrium(model, is_free).solve(x, load, 2);
      double tip = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        if (load[i].z() != 0.0) tip += (mesh.nodes[i].z() - x[i].z()) / at_tip;
      }
      results.push_back({n, static_cast<int>(mesh.tetrahedra.size()), nu, tip / beam});
    }
  }
  return results;
}

}  // namespace softfinger::validation
