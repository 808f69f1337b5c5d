#include "softfinger/finger/finger_potential.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

/// Moments count as forces at this lever arm when gradients are measured, m.
constexpr double kLeverArm = 8e-3;
/// Below this force, N, the residual is absolute: free flight has no force to compare with.
constexpr double kForceFloor = 1e-3;
/// Contact stiffness per area is this times the tissue's modulus, 1/m: a pressure as large as the
/// modulus sinks in by the inverse.
constexpr double kContactStiffness = 3e5;

/// Mean Young's modulus of what deforms, by rest volume, Pa.
double mean_modulus(const FingerModel& model) {
  double volume = 0.0;
  double sum = 0.0;
  for (std::size_t t = 0; t < model.mesh.tetrahedra.size(); ++t) {
    const int material = model.tetrahedron_material[t];
    if (material < 0) continue;
    const auto at = [&](std::size_t k) -> const Vector3& {
      return model.mesh.nodes[static_cast<std::size_t>(model.mesh.tetrahedra[t][k])];
    };
    const double v = std::abs((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)));
    volume += v;
    sum += v * model.materials[static_cast<std::size_t>(material)].youngs_modulus;
  }
  return volume > 0.0 ? sum / volume : 0.0;
}

std::vector<ElasticMaterial> elastic_materials(const FingerModel& model) {
  return {model.materials.begin(), model.materials.end()};
}

std::vector<ContactCorrection::Carrier> carriers(const FingerModel& model, const UnknownMap& map) {
  std::vector<ContactCorrection::Carrier> carriers;
  for (const int node : model.sample_nodes) {
    carriers.emplace_back().blocks[0] = map.block_of_node[static_cast<std::size_t>(node)];
  }
  carriers.resize(carriers.size() + FeaturePoints::kMost);
  return carriers;
}

std::vector<double> contact_areas(const FingerModel& model) {
  std::vector<double> areas = model.sample_rest_areas;
  areas.resize(areas.size() + FeaturePoints::kMost, FeaturePoints::kArea);
  return areas;
}

}  // namespace

ContactPotential::Options contact_options(const FingerModel& model) {
  ContactPotential::Options options;
  const double modulus = mean_modulus(model);
  if (modulus > 0.0) options.stiffness_per_area = kContactStiffness * modulus;
  return options;
}

FingerPotential::FingerPotential(const FingerModel& model, Bone bone, std::size_t obstacle_count,
                                 const Options& options)
    : model_(model),
      gravity_(options.gravity),
      bone_mode_(bone),
      map_(make_unknown_map(model.node_is_rigid, bone == Bone::kCoupled)),
      elastic_(model.mesh, elastic_materials(model), model.tetrahedron_material,
               model.node_is_rigid, options.strain_limits ? model.strain_limits : StrainLimit{},
               model.dilatation, model.relaxation, options.instruction_set),
      team_(elastic_.is_worth_sharing() ? options.team : nullptr),
      assembly_(elastic_, map_, options.instruction_set, team_ == nullptr ? 1 : team_->threads()),
      bone_(bone == Bone::kCoupled ? bone_inertia(model, elastic_.masses()) : BoneInertia{},
            model.coupling),
      contact_(contact_areas(model), model.sample_nodes.size(), obstacle_count,
               contact_options(model)),
      correction_(carriers(model, map_), static_cast<std::size_t>(3 * map_.blocks()), team_),
      features_(model, obstacle_count),
      starts_(model.sample_nodes.size()),
      work_(elastic_.make_work()) {
  const std::size_t nodes = model.mesh.nodes.size();
  const auto unknowns = static_cast<std::size_t>(3 * map_.blocks());
  for (Point* point : {&current_, &trial_}) {
    point->positions = model.mesh.nodes;
    point->gradient.assign(unknowns, 0.0);
  }
  direction_.assign(unknowns, 0.0);
  predicted_.assign(nodes, Vector3::Zero());
  elastic_gradient_.assign(nodes, Vector3::Zero());
  node_gradient_ = elastic_gradient_;
  if (bone == Bone::kPrescribed) loads_ = node_gradient_;
  lever_arms_.assign(nodes, Vector3::Zero());
  const std::size_t contact_points = model.sample_nodes.size() + FeaturePoints::kMost;
  contact_positions_.assign(contact_points, Vector3::Zero());
  contact_gradient_ = contact_positions_;
  contact_blocks_.assign(contact_points, Matrix3::Zero());
}

void FingerPotential::forget() {
  has_factor_ = false;
  elastic_.reset(work_);
  contact_.forget();
  cache_is_current_ = false;
}

void FingerPotential::begin(const Step& step) {
  step_ = step;
  for (std::size_t i = 0; i < starts_.size(); ++i) {
    starts_[i] = step.old_positions[static_cast<std::size_t>(model_.sample_nodes[i])];
  }
  contact_.begin(step.obstacles, step.anchors, starts_);
  if (step.relaxed) {
    elastic_.begin_relaxed(work_);
  } else if (step.history != nullptr) {
    elastic_.begin_step(*step.history, step.time_step > 0.0 ? step.time_step : step.elapsed, work_);
  }
  if (step.time_step > 0.0) {
    // Weight is where motion without other forces leads, so that it needs no energy of its own.
    const Vector3 fall = step.time_step * step.time_step * gravity_;
    for (std::size_t n = 0; n < predicted_.size(); ++n) {
      predicted_[n] = step.old_positions[n] + step.time_step * step.velocities[n] + fall;
    }
  }
  if (bone_mode_ == Bone::kCoupled) {
    bone_.begin(step.old_bone, step.X_WFt_old, step.X_WFt, step.time_step);
  }
  choose_features();
}

void FingerPotential::choose_features() {
  if (!model_.feature_contact) return;
  const std::size_t samples = model_.sample_nodes.size();
  if (!step_.features_given) {
    FeaturePoints::Step step;
    step.old_positions = step_.old_positions;
    step.positions = step_.seen_positions;
    if (step.positions.empty()) {
      step.positions =
          step_.time_step > 0.0 ? std::span<const Vector3>(predicted_) : step.old_positions;
    }
    step.obstacles = step_.obstacles;
    features_.choose(step, contact_, correction_,
                     step_.anchors.subspan(samples * step_.obstacles.size()));
  }
  for (std::size_t k = 0; k < features_.points().size(); ++k) {
    const FeaturePoints::Point& point = features_.points()[k];
    ContactCorrection::Carrier carrier;
    carrier.weights = point.weights;
    for (std::size_t c = 0; c < 3; ++c) {
      carrier.blocks[c] = map_.block_of_node[static_cast<std::size_t>(point.nodes[c])];
    }
    correction_.set_carrier(samples + k, carrier);
    contact_.add_plane(point.plane);
  }
}

void FingerPotential::put_contact_points(std::span<const Vector3> nodes) {
  const std::size_t samples = model_.sample_nodes.size();
  for (std::size_t i = 0; i < samples; ++i) {
    contact_positions_[i] = nodes[static_cast<std::size_t>(model_.sample_nodes[i])];
  }
  for (std::size_t k = 0; k < features_.points().size(); ++k) {
    contact_positions_[samples + k] = features_.position(features_.points()[k], nodes);
  }
}

void FingerPotential::put_tied_nodes(Point& point) const {
  for (std::size_t n = 0; n < point.positions.size(); ++n) {
    if (map_.block_of_node[n] < 0) point.positions[n] = point.X_WF * model_.mesh.nodes[n];
  }
}

void FingerPotential::start_from(std::span<const Vector3> positions, const Pose& X_WF) {
  std::copy(positions.begin(), positions.end(), current_.positions.begin());
  current_.X_WF = bone_mode_ == Bone::kPrescribed ? step_.X_WFt : X_WF;
  put_tied_nodes(current_);
  evaluate_current();
}

void FingerPotential::start_from_prediction() {
  const BoneState& bone = step_.old_bone;
  Pose X_WF;
  X_WF.translation = bone.X_WF.translation + step_.time_step * bone.velocity;
  X_WF.rotation = orthonormalised(bone.X_WF.rotation + step_.time_step * bone.rotation_rate);
  start_from(predicted_, X_WF);
}

void FingerPotential::limit_strain(bool limited) {
  work_.limited = limited;
  has_factor_ = false;
  evaluate_current();
}

void FingerPotential::renew() {
  if (!cache_is_current_) {
    evaluate_current();
    return;
  }
  meet(At::kCurrent);
  add_up(At::kCurrent);
}

bool FingerPotential::is_tangled() const { return elastic_.stretches(work_).min < 0.0; }

void FingerPotential::settle() {
  if (cache_is_current_) return;
  evaluate_current();
}

void FingerPotential::meet(At at) {
  Point& point = this->point(at);
  put_contact_points(point.positions);
  std::fill_n(contact_gradient_.begin(), contact_points(), Vector3::Zero());
  point.contact_energy = contact_.energy_gradient(contact_positions(), contact_gradient_);
}

void FingerPotential::complete(At at) {
  Point& point = this->point(at);
  cache_is_current_ = at == At::kCurrent;
  std::fill(elastic_gradient_.begin(), elastic_gradient_.end(), Vector3::Zero());
  point.elastic_energy = elastic_.energy_gradient(point.positions, work_, elastic_gradient_, team_);
  add_up(at);
}

void FingerPotential::add_up(At at) {
  Point& point = this->point(at);
  std::copy(elastic_gradient_.begin(), elastic_gradient_.end(), node_gradient_.begin());
  point.energy = point.elastic_energy + point.contact_energy;
  const std::size_t samples = model_.sample_nodes.size();
  for (std::size_t i = 0; i < samples; ++i) {
    node_gradient_[static_cast<std::size_t>(model_.sample_nodes[i])] += contact_gradient_[i];
  }
  for (std::size_t k = 0; k < features_.points().size(); ++k) {
    const FeaturePoints::Point& feature = features_.points()[k];
    for (std::size_t c = 0; c < 3; ++c) {
      node_gradient_[static_cast<std::size_t>(feature.nodes[c])] +=
          feature.weights[c] * contact_gradient_[samples + k];
    }
  }

  double inertia_squared = 0.0;
  double load_squared = 0.0;
  for (std::size_t n = 0; n < loads_.size(); ++n) {
    node_gradient_[n] -= loads_[n];
    load_squared += loads_[n].squaredNorm();
  }
  if (step_.time_step > 0.0) {
    const double w = 1.0 / (step_.time_step * step_.time_step);
    for (std::size_t n = 0; n < predicted_.size(); ++n) {
      // The inertia of tied nodes is part of the bone's.
      if (map_.block_of_node[n] < 0) continue;
      const Vector3 dx = point.positions[n] - predicted_[n];
      const Vector3 force = w * elastic_.masses()[n] * dx;
      point.energy += 0.5 * force.dot(dx);
      node_gradient_[n] += force;
      inertia_squared += force.squaredNorm();
    }
  }

  double squared_norm = 0.0;
  double coupling_norm = 0.0;
  reduce_gradient(point, squared_norm);
  if (bone_mode_ == Bone::kCoupled) {
    const BonePotential::Value bone = bone_.evaluate(point.X_WF);
    point.energy += bone.energy;
    inertia_squared += bone.inertia_norm * bone.inertia_norm;
    coupling_norm = bone.coupling_norm;
    double* g = point.gradient.data() + 3 * map_.translation_block();
    Eigen::Map<Vector3> by_translation(g);
    Eigen::Map<Vector3> by_rotation(g + 3);
    by_translation += bone.by_translation;
    by_rotation += bone.by_rotation;
    squared_norm +=
        by_translation.squaredNorm() + by_rotation.squaredNorm() / (kLeverArm * kLeverArm);
  }
  const double scale = std::max({std::sqrt(inertia_squared), contact_.force_norm(),
                                 std::sqrt(load_squared), coupling_norm, kForceFloor});
  point.residual = std::sqrt(squared_norm) / scale;
}

void FingerPotential::reduce_gradient(Point& point, double& squared_norm) const {
  Vector3 force = Vector3::Zero();
  Vector3 torque = Vector3::Zero();
  point.moments.setZero();
  for (std::size_t n = 0; n < node_gradient_.size(); ++n) {
    const Vector3& g = node_gradient_[n];
    const int block = map_.block_of_node[n];
    if (block >= 0) {
      Eigen::Map<Vector3>{point.gradient.data() + 3 * block} = g;
      squared_norm += g.squaredNorm();
    } else if (map_.body_moves) {
      const Vector3 arm = point.positions[n] - point.X_WF.translation;
      force += g;
      torque += arm.cross(g);
      point.moments += g * arm.transpose();
    }
  }
  if (!map_.body_moves) return;
  double* g = point.gradient.data() + 3 * map_.translation_block();
  Eigen::Map<Vector3>{g} = force;
  Eigen::Map<Vector3>{g + 3} = torque;
}

bool FingerPotential::factorise(HessianKind kind) {
  settle();
  has_factor_ = false;
  for (std::size_t n = 0; n < lever_arms_.size(); ++n) {
    lever_arms_[n] = current_.positions[n] - current_.X_WF.translation;
  }
  assembly_.clear(lever_arms_);
  const bool projected = kind == HessianKind::kProjected;
  assembly_.add_elastic(elastic_, work_, projected);
  const std::size_t samples = model_.sample_nodes.size();
  for (std::size_t i = 0; i < contact_points(); ++i) {
    if (!contact_.hessian(i, kind == HessianKind::kFull, contact_blocks_[i])) continue;
    if (i < samples) {
      assembly_.add_node(model_.sample_nodes[i], contact_blocks_[i]);
    } else {
      const FeaturePoints::Point& point = features_.points()[i - samples];
      assembly_.add_point(point.nodes, point.weights, contact_blocks_[i]);
    }
  }
  if (step_.time_step > 0.0) {
    const double w = 1.0 / (step_.time_step * step_.time_step);
    for (std::size_t n = 0; n < predicted_.size(); ++n) {
      if (map_.block_of_node[n] < 0) continue;
      assembly_.add_node(static_cast<int>(n), w * elastic_.masses()[n] * Matrix3::Identity());
    }
  }
  if (bone_mode_ == Bone::kCoupled) {
    BonePotential::Hessian h = bone_.hessian(current_.X_WF, projected);
    if (!projected) h.rotation += BonePotential::geometric(current_.moments);
    assembly_.add_body(h.translation, h.translation_rotation, h.rotation);
  }
  has_factor_ = assembly_.factor(team_);
  correction_.restart({contact_blocks_.data(), contact_points()});
  return has_factor_;
}

double FingerPotential::solve_direction(bool refined) {
  solve_alone();
  if (refined) {
    start_correction();
    apply_correction();
  }
  return slope();
}

void FingerPotential::solve_alone() {
  for (std::size_t i = 0; i < direction_.size(); ++i) direction_[i] = -current_.gradient[i];
  assembly_.solve(direction_, team_);
}

void FingerPotential::yield_to(const ObstacleCoupling& coupling, const Vector6& xi) {
  for (int c = 0; c < 6; ++c) {
    const std::vector<double>& response = coupling.responses[static_cast<std::size_t>(c)];
    for (std::size_t i = 0; i < direction_.size(); ++i) direction_[i] -= xi[c] * response[i];
  }
}

void FingerPotential::start_correction() {
  put_contact_points(current_.positions);
  correction_.start(contact_, contact_positions());
}

void FingerPotential::correct_direction(std::span<const Vector3> carried, double way) {
  correction_.move_obstacles(carried, way);
  apply_correction();
}

void FingerPotential::apply_correction() {
  double squared_norm = 0.0;
  for (const double g : current_.gradient) squared_norm += g * g;
  correction_.apply(contact_, assembly_, contact_positions(), std::sqrt(squared_norm), direction_);
}

double FingerPotential::slope() const {
  double slope = 0.0;
  for (std::size_t i = 0; i < direction_.size(); ++i) slope += direction_[i] * current_.gradient[i];
  return slope;
}

ObstacleCoupling FingerPotential::make_coupling() const {
  ObstacleCoupling coupling;
  coupling.by_point.assign(contact_positions_.size(), Matrix36::Zero());
  for (std::vector<double>& column : coupling.columns) column.assign(direction_.size(), 0.0);
  coupling.responses = coupling.columns;
  return coupling;
}

void FingerPotential::couple(std::size_t o, HessianKind kind, ObstacleCoupling& coupling) const {
  coupling.touches = false;
  const Vector3& origin = step_.obstacles[o].X_WO.translation;
  const std::size_t samples = model_.sample_nodes.size();
  ContactPotential::PairResponse pair;
  for (std::size_t i = 0; i < contact_points(); ++i) {
    if (!contact_.pair_response(i, o, kind == HessianKind::kFull, pair)) continue;
    const Vector3 r = contact_positions_[i] - origin;
    if (!coupling.touches) coupling.clear();
    coupling.add(i, r, pair.gradient, pair.hessian, kind != HessianKind::kProjected);
    if (i < samples) {
      add_loads(model_.sample_nodes[i], 1.0, coupling.by_point[i], coupling.columns);
      continue;
    }
    const FeaturePoints::Point& point = features_.points()[i - samples];
    for (std::size_t k = 0; k < 3; ++k) {
      add_loads(point.nodes[k], point.weights[k], coupling.by_point[i], coupling.columns);
    }
  }
  if (!coupling.touches) return;
  std::array<std::span<double>, 6> responses;
  for (std::size_t c = 0; c < 6; ++c) {
    coupling.responses[c] = coupling.columns[c];
    responses[c] = coupling.responses[c];
  }
  assembly_.solve_together(responses, team_);
}

void FingerPotential::add_loads(int node, double weight, const Matrix36& by_point,
                                std::array<std::vector<double>, 6>& columns) const {
  for (int c = 0; c < 6; ++c) {
    add_load(node, weight * by_point.col(c), columns[static_cast<std::size_t>(c)]);
  }
}

void FingerPotential::add_load(int node, const Vector3& load, std::span<double> unknowns) const {
  const int block = map_.block_of_node[static_cast<std::size_t>(node)];
  if (block < 0 && !map_.body_moves) return;
  const int at = block >= 0 ? block : map_.translation_block();
  Eigen::Map<Vector3>{unknowns.data() + 3 * at} += load;
  if (block >= 0) return;
  Eigen::Map<Vector3>{unknowns.data() + 3 * map_.rotation_block()} +=
      lever_arms_[static_cast<std::size_t>(node)].cross(load);
}

Vector3 FingerPotential::motion(int node, std::span<const double> unknowns) const {
  const int block = map_.block_of_node[static_cast<std::size_t>(node)];
  const auto at = [&](int b) { return Eigen::Map<const Vector3>(unknowns.data() + 3 * b); };
  if (block >= 0) return at(block);
  if (!map_.body_moves) return Vector3::Zero();
  return at(map_.translation_block()) +
         at(map_.rotation_block()).cross(lever_arms_[static_cast<std::size_t>(node)]);
}

void FingerPotential::step_back(std::span<const double> x) {
  for (std::size_t i = 0; i < direction_.size(); ++i) direction_[i] -= x[i];
}

void FingerPotential::put_trial(double t) {
  trial_.X_WF = current_.X_WF;
  if (bone_mode_ == Bone::kCoupled) {
    const double* d = direction_.data() + 3 * map_.translation_block();
    trial_.X_WF.translation += t * Eigen::Map<const Vector3>(d);
    trial_.X_WF.rotation =
        exp_rotation(t * Eigen::Map<const Vector3>(d + 3)) * current_.X_WF.rotation;
  }
  for (std::size_t n = 0; n < trial_.positions.size(); ++n) {
    const int block = map_.block_of_node[n];
    trial_.positions[n] =
        block >= 0 ? Vector3(current_.positions[n] +
                             t * Eigen::Map<const Vector3>(direction_.data() + 3 * block))
                   : trial_.X_WF * model_.mesh.nodes[n];
  }
}

double FingerPotential::largest_free_force() const {
  double largest = 0.0;
  for (int i = 0; i < 3 * map_.free_blocks; ++i) {
    largest = std::max(largest, std::abs(current_.gradient[static_cast<std::size_t>(i)]));
  }
  return largest;
}

}  // namespace softfinger
