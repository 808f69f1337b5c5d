#include "softfinger/fem/elastic_model.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

#include "softfinger/fem/dilatation_patches.hpp"

namespace softfinger {
namespace {

/// Fewer elements are evaluated before another thread has noticed.
constexpr std::size_t kWorthSharing = 1000;
/// Parts of an evaluation that threads share.
constexpr std::size_t kSlices = 4;

Matrix3 edges(std::span<const Vector3> x, const std::array<int, 4>& t) {
  const auto at = [&](int a) -> const Vector3& {
    return x[static_cast<std::size_t>(t[static_cast<std::size_t>(a)])];
  };
  Matrix3 d;
  d << at(1) - at(0), at(2) - at(0), at(3) - at(0);
  return d;
}

}  // namespace

ElasticModel::ElasticModel(const TetrahedralMesh& mesh, std::span<const ElasticMaterial> materials,
                           std::span<const int> element_material, const std::vector<bool>& tied,
                           const StrainLimit& limit, Dilatation dilatation, Relaxation relaxation,
                           InstructionSet set)
    : masses_(mesh.nodes.size(), 0.0),
      relaxation_(std::move(relaxation)),
      limit_(limit),
      kernels_(&element_kernels(set)) {
  const auto is_tied = [&](int node) { return tied[static_cast<std::size_t>(node)]; };
  std::vector<std::size_t> apart_from_body, beside_body;
  std::vector<int> deforming_material(element_material.begin(), element_material.end());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    if (element_material[e] < 0) continue;
    const auto& tetrahedron = mesh.tetrahedra[e];
    const double density = materials[static_cast<std::size_t>(element_material[e])].density;
    const double volume = edges(mesh.nodes, tetrahedron).determinant() / 6.0;
    for (int node : tetrahedron) {
      masses_[static_cast<std::size_t>(node)] += 0.25 * density * volume;
    }
    const auto tied_nodes = std::count_if(tetrahedron.begin(), tetrahedron.end(), is_tied);
    if (tied_nodes == 4) {
      deforming_material[e] = -1;
    } else {
      (tied_nodes == 0 ? apart_from_body : beside_body).push_back(e);
    }
  }
  std::vector<int> patch(mesh.tetrahedra.size(), -1);
  if (dilatation == Dilatation::kPatch) {
    patch = dilatation_patches(mesh.nodes, mesh.tetrahedra, deforming_material);
    patches_.resize(static_cast<std::size_t>(*std::max_element(patch.begin(), patch.end()) + 1));
  }
  const auto add = [&](std::size_t e) {
    add_element(mesh, e, materials[static_cast<std::size_t>(element_material[e])], tied, patch[e]);
  };
  for (const std::size_t e : apart_from_body) add(e);
  // Last, so that few groups have anything to do with the body.
  first_body_group_ = elements_ / kLaneCount;
  for (const std::size_t e : beside_body) add(e);
  if (patches_.empty()) return;
  number_patch_nodes();
  patch_of_tetrahedron_ = std::move(patch);
}

void ElasticModel::add_element(const TetrahedralMesh& mesh, std::size_t e,
                               const ElasticMaterial& material, const std::vector<bool>& tied,
                               int patch) {
  const auto& tetrahedron = mesh.tetrahedra[e];
  const std::size_t lane = elements_ % kLaneCount;
  if (lane == 0) groups_.push_back(ElementGroup{});
  ElementGroup& group = groups_.back();
  const Matrix3 rest = edges(mesh.nodes, tetrahedron);
  const Matrix3 shape = rest.inverse();  // row a: grad N_{a+1}
  for (std::size_t a = 0; a < 4; ++a) {
    group.nodes[a][lane] = tetrahedron[a];
    group.tied[a][lane] = tied[static_cast<std::size_t>(tetrahedron[a])] ? 1.0 : 0.0;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t k = 0; k < 3; ++k) {
      group.shape[a][k][lane] = shape(static_cast<int>(a), static_cast<int>(k));
    }
  }
  group.volume[lane] = rest.determinant() / 6.0;
  group.mu[lane] = material.mu();
  group.lambda[lane] = patch < 0 ? material.lambda() : 0.0;
  if (patch >= 0) {
    Patch& whole = patches_[static_cast<std::size_t>(patch)];
    whole.volume += group.volume[lane];
    whole.lambda = material.lambda();
    whole.nodes.insert(whole.nodes.end(), tetrahedron.begin(), tetrahedron.end());
    memberships_.push_back({patch, 0, {}});
  }
  ++elements_;
}

void ElasticModel::number_patch_nodes() {
  std::vector<int> first(patches_.size(), 0);
  int count = 0;
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    std::vector<int>& nodes = patches_[p].nodes;
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    first[p] = count;
    count += static_cast<int>(nodes.size());
  }
  for (std::size_t e = 0; e < memberships_.size(); ++e) {
    Membership& membership = memberships_[e];
    const auto p = static_cast<std::size_t>(membership.patch);
    const std::vector<int>& nodes = patches_[p].nodes;
    membership.first = first[p];
    for (std::size_t a = 0; a < 4; ++a) {
      const int node = groups_[e / kLaneCount].nodes[a][e % kLaneCount];
      const auto found = std::lower_bound(nodes.begin(), nodes.end(), node);
      membership.at[a] = static_cast<int>(found - nodes.begin());
    }
  }
}

bool ElasticModel::is_worth_sharing() const { return elements_ >= kWorthSharing; }

ElasticModel::Work ElasticModel::make_work() const {
  Work work;
  work.decompositions.resize(groups_.size());
  if (!patches_.empty()) work.dilatations.resize(groups_.size());
  work.pressures.assign(patches_.size(), 0.0);
  if (!relaxation_.terms.empty()) work.memory.resize(groups_.size());
  if (is_worth_sharing()) {
    work.slices.assign(kSlices, {0.0, std::vector<Vector3>(masses_.size(), Vector3::Zero())});
  }
  reset(work);
  return work;
}

void ElasticModel::reset(Work& work) const {
  for (ElementDecomposition& d : work.decompositions) {
    d = ElementDecomposition{};
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      for (std::size_t i = 0; i < 3; ++i) {
        d.v[4 * i][lane] = d.s[i][lane] = 1.0;
        d.u[4 * i][lane] = 1.0F;
      }
    }
  }
}

void ElasticModel::begin_step(const StressHistory& history, double time_step, Work& work) const {
  if (work.memory.empty()) return;
  if (time_step > 0.0) {
    work.factor = relaxation_.step_fraction(time_step);
    recall(relaxation_, history, time_step, work.memory);
  } else {
    work.factor = 1.0;
    std::fill(work.memory.begin(), work.memory.end(), ElementStress{});
  }
}

void ElasticModel::begin_relaxed(Work& work) const {
  std::fill(work.memory.begin(), work.memory.end(), ElementStress{});
  work.factor = relaxation_.long_time_fraction();
}

void ElasticModel::end_step(const Work& work, double time_step, StressHistory& history) const {
  if (work.memory.empty() || !(time_step > 0.0)) return;
  alignas(64) double pressures[kLanes];
  ElementStress elastic;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    read_pressures(work, g, 1.0 / work.factor, pressures);
    kernels_->elastic_stress(groups_[g], work.decompositions[g], pressures, &elastic);
    remember(relaxation_, time_step, g, elastic, history);
  }
}

void ElasticModel::read_pressures(const Work& work, std::size_t group, double scale,
                                  double (&pressures)[kLanes]) const {
  std::fill(std::begin(pressures), std::end(pressures), 0.0);
  for (std::size_t lane = 0; lane < kLaneCount && !patches_.empty(); ++lane) {
    const std::size_t e = group * kLaneCount + lane;
    if (e >= elements_) break;
    pressures[lane] = scale * work.pressures[static_cast<std::size_t>(memberships_[e].patch)];
  }
}

double ElasticModel::evaluate_groups(std::size_t begin, std::size_t end,
                                     std::span<const Vector3> positions, Work& work,
                                     std::span<Vector3> gradient) const {
  StrainLimit limit = limit_;
  if (!work.limited) limit.stiffness = 0.0;
  double energy = 0.0;
  ElementForces forces;
  for (std::size_t g = begin; g < end; ++g) {
    const ElementGroup& group = groups_[g];
    energy += kernels_->energy_gradient(group, limit, viscosity(work, g), positions.data()->data(),
                                        &work.decompositions[g], &forces,
                                        patches_.empty() ? nullptr : &work.dilatations[g]);
    const std::size_t lanes = std::min(kLaneCount, elements_ - g * kLaneCount);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      for (std::size_t a = 0; a < 4; ++a) {
        Vector3& sum = gradient[static_cast<std::size_t>(group.nodes[a][lane])];
        sum.x() += forces.force[a][0][lane];
        sum.y() += forces.force[a][1][lane];
        sum.z() += forces.force[a][2][lane];
      }
    }
  }
  return energy;
}

double ElasticModel::energy_gradient(std::span<const Vector3> positions, Work& work,
                                     std::span<Vector3> gradient, ThreadTeam* team) const {
  double energy = 0.0;
  if (work.slices.empty()) {
    energy = evaluate_groups(0, groups_.size(), positions, work, gradient);
  } else {
    const std::size_t count = work.slices.size();
    share_from_both_ends(team, count, [&](std::size_t s, int) {
      Work::Slice& slice = work.slices[s];
      std::fill(slice.gradient.begin(), slice.gradient.end(), Vector3::Zero());
      slice.energy = evaluate_groups(groups_.size() * s / count, groups_.size() * (s + 1) / count,
                                     positions, work, slice.gradient);
    });
    for (const Work::Slice& slice : work.slices) {
      energy += slice.energy;
      for (std::size_t n = 0; n < gradient.size(); ++n) gradient[n] += slice.gradient[n];
    }
  }
  if (!patches_.empty()) add_patch_pressures(work, gradient, energy);
  return energy;
}

void ElasticModel::add_patch_pressures(Work& work, std::span<Vector3> gradient,
                                       double& energy) const {
  std::fill(work.pressures.begin(), work.pressures.end(), 0.0);
  for (std::size_t e = 0; e < elements_; ++e) {
    work.pressures[static_cast<std::size_t>(memberships_[e].patch)] +=
        work.dilatations[e / kLaneCount].value[e % kLaneCount];
  }
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const double mean = work.pressures[p] / patches_[p].volume;
    work.pressures[p] = work.factor * patches_[p].lambda * mean;
    energy += 0.5 * work.pressures[p] * patches_[p].volume * mean;
  }
  for (std::size_t e = 0; e < elements_; ++e) {
    const ElementGroup& group = groups_[e / kLaneCount];
    const ElementDilatation& dilatation = work.dilatations[e / kLaneCount];
    const std::size_t lane = e % kLaneCount;
    const double pressure = work.pressures[static_cast<std::size_t>(memberships_[e].patch)];
    for (std::size_t a = 0; a < 4; ++a) {
      Vector3& sum = gradient[static_cast<std::size_t>(group.nodes[a][lane])];
      sum.x() += pressure * dilatation.force[a][0][lane];
      sum.y() += pressure * dilatation.force[a][1][lane];
      sum.z() += pressure * dilatation.force[a][2][lane];
    }
  }
}

void ElasticModel::patch_gradients(const Work& work, std::span<Vector3> gradients) const {
  std::fill(gradients.begin(), gradients.end(), Vector3::Zero());
  for (std::size_t e = 0; e < memberships_.size(); ++e) {
    const ElementDilatation& dilatation = work.dilatations[e / kLaneCount];
    const std::size_t lane = e % kLaneCount;
    for (std::size_t a = 0; a < 4; ++a) {
      gradients[static_cast<std::size_t>(memberships_[e].first + memberships_[e].at[a])] += Vector3(
          dilatation.force[a][0][lane], dilatation.force[a][1][lane], dilatation.force[a][2][lane]);
    }
  }
}

void ElasticModel::hessian(std::size_t group, const Work& work, bool projected,
                           ElementHessians& hessians) const {
  alignas(64) double pressures[kLanes];
  read_pressures(work, group, 1.0, pressures);
  kernels_->hessian(groups_[group], work.factor, work.decompositions[group], pressures,
                    !work.memory.empty(), projected, &hessians);
}

void ElasticModel::body_hessian(std::size_t group, std::span<const Vector3> lever_arms,
                                const ElementHessians& hessians, ElementBodyHessians& rows,
                                BodyHessianSums& sums) const {
  kernels_->body_hessian(groups_[group], lever_arms.data()->data(), hessians, &rows, &sums);
}

double ElasticModel::volume_ratio(std::span<const Vector3> positions) const {
  double rest = 0.0;
  double deformed = 0.0;
  for (std::size_t e = 0; e < elements_; ++e) {
    const ElementGroup& group = groups_[e / kLaneCount];
    const std::size_t lane = e % kLaneCount;
    const Matrix3 d = edges(positions, {group.nodes[0][lane], group.nodes[1][lane],
                                        group.nodes[2][lane], group.nodes[3][lane]});
    rest += group.volume[lane];
    deformed += d.determinant() / 6.0;
  }
  return rest > 0.0 ? deformed / rest : 1.0;
}

ElasticModel::Stretches ElasticModel::stretches(const Work& work) const {
  Stretches result;
  if (elements_ == 0) return result;
  result = {1e300, -1e300};
  for (std::size_t e = 0; e < elements_; ++e) {
    const ElementDecomposition& d = work.decompositions[e / kLaneCount];
    for (const auto& s : d.s) {
      result.min = std::min(result.min, s[e % kLaneCount]);
      result.max = std::max(result.max, s[e % kLaneCount]);
    }
  }
  return result;
}

}  // namespace softfinger
