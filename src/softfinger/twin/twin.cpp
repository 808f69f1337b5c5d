#include "softfinger/twin/twin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "softfinger/finger/finger_contact.hpp"
#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/finger/finger_size.hpp"
#include "softfinger/finger/minimise_in_cone.hpp"
#include "softfinger/twin/piece_motion.hpp"

namespace softfinger {
namespace {

/// No piece of the device moves on the skin in parts longer than this, so that friction sees the
/// path, m.
constexpr double kLongestPart = 0.25e-3;
/// A jump has no path worth following: no more parts than this.
constexpr int kMostParts = 16;
constexpr int kIterations = 120;  // a press
struct Tolerances {
  double residual = 0.0;  ///< relative
  double roughly = 0.0;   ///< likewise, while friction limits and features still change
  /// Lagged friction limits are renewed until they change by less than this, N, ...
  double friction = 0.0;
  double friction_part = 0.0;  ///< ... or this part of the normal force
};
Tolerances tolerances_for(TwinPrecision precision) {
  if (precision == TwinPrecision::kJudging) return {1e-7, 1e-4, 1e-5, 0.0};
  return {1e-4, 1e-3, 1e-5, 1e-3};
}
constexpr int kFrictionPasses = 20;
/// Features are met as planes, where they were seen before the skin moved: it looks again.
constexpr int kLooks = 2;
/// Residual of skin that is taken to be where it was foreseen, whatever its energy elsewhere.
constexpr double kNearBalance = 0.3;
/// Translations and rotations.
constexpr int kMountMotions = 6;
/// What of a derivative goes through friction's limits and planes is iterated for, to this part.
constexpr double kDragTolerance = 1e-4;
constexpr int kDragRounds = 12;
/// Components whose right-hand sides are solved for at once.
constexpr std::size_t kDragsTogether = 12;

}  // namespace

Vector3 normal_force_vector(const ContactSet& contact) {
  return contact.normal_force * contact.mean_normal_F;
}

struct Twin::Implementation {
  Implementation(std::shared_ptr<const FingerModel> the_wearer,
                 std::shared_ptr<const Device> the_device, TwinPrecision the_precision)
      : wearer(std::move(the_wearer)),
        device(std::move(the_device)),
        precision(the_precision),
        pieces(static_cast<std::size_t>(device->solid_piece_count())),
        obstacles(pieces.size()),
        motions(*device),
        potential(*wearer, FingerPotential::Bone::kPrescribed, pieces.size(), {}),
        kept_anchors(potential.contact().no_anchors()),
        history(potential.elastic().make_history()),
        anchors(kept_anchors),
        contact(make_contact_set(*wearer)),
        shifts(static_cast<std::size_t>(device->degrees_of_freedom()) + kMountMotions,
               std::vector<double>(potential.gradient().size())) {
    for (Drag& drag : drags) {
      drag.pushed.resize(potential.gradient().size());
      drag.rubbed.resize(potential.gradient().size());
    }
    touching.reserve(pieces.size() * (wearer->sample_nodes.size() + FeaturePoints::kMost));
    for (std::size_t k = 0; k < pieces.size(); ++k) obstacles[k].shape = &pieces[k].shape;
    reset(device->home(), wearer->mesh.nodes);
  }

  std::shared_ptr<const FingerModel> wearer;
  std::shared_ptr<const Device> device;
  TwinPrecision precision;
  std::vector<SolidPiece> pieces;
  std::vector<Obstacle> obstacles;
  PieceMotions motions;
  FingerPotential potential;
  // At the end of the last frame kept.
  std::vector<Vector3> kept_positions;
  std::vector<FrictionAnchor> kept_anchors;
  StressHistory history;
  Configuration kept_q;
  std::vector<Pose> kept_poses;  ///< of the pieces
  FeaturePoints::State kept_features;
  // Of the frame under way.
  double friction_coefficient = 0.0;
  double elapsed = 0.0;
  std::stop_token stop;
  Configuration q;
  std::vector<Vector3> positions;
  std::vector<Vector3> foreseen;
  std::vector<FrictionAnchor> anchors;
  ContactSet contact;
  std::array<PieceMotion, kMountMotions> mount_motions;
  /// Of the unknowns, by each component of q and of the mount.
  std::vector<std::vector<double>> shifts;
  /// Scratch of drag_by(), of one component, by unknowns.
  struct Drag {
    int k = 0;
    bool settled = false;
    std::vector<double> pushed, rubbed;
  };
  std::array<Drag, kDragsTogether> drags;
  struct TouchingPair {
    std::size_t point, piece;
    ContactPotential::PairResponse response;
  };
  std::vector<TouchingPair> touching;  ///< at the last attempt
  bool shifts_known = false;           ///< at the last attempt, or one before it
  // Where the last attempt began, if it was given up.
  bool given_up = false;
  Configuration tried_from_q;
  std::vector<Vector3> tried_from;

  void reset(const Configuration& at, std::span<const Vector3> from);
  void place();
  void keep_poses();
  void begin(std::span<const Vector3> seen_positions, bool features_given = false);
  TwinSummary attempt(const Configuration& at, int most_iterations = Twin::kAsManyAsItTakes);
  void foresee(const Configuration& at);
  void start(bool was_foreseen);
  void keep();
  [[nodiscard]] bool forces_and_derivatives(TwinForces& forces);
  [[nodiscard]] bool load_and_derivative(DeviceLoad& load);
  [[nodiscard]] bool force_by_mount(const Vector3& origin_F, Vector6& by_mount,
                                    Eigen::VectorXd& by_q);
  void take_place_of(const Implementation& at);
  [[nodiscard]] Vector3 normal_force() const;
  /// By component k of q or, from the degrees of freedom on, of the mount.
  [[nodiscard]] const PieceMotion& motion(std::size_t piece, int k) const {
    const int dof = device->degrees_of_freedom();
    return k < dof ? motions(piece, k) : mount_motions[static_cast<std::size_t>(k - dof)];
  }
  void find_touching(bool with_curvature);
  void drag_by(int first, int end);
  void drag_together(std::span<Drag> together);
  void add_push(int k, bool rubbing, std::span<const double> shift, std::span<double> push) const;
  /// How the forces of a touching pair grow with a component of q.
  struct ForceRates {
    Vector3 normal, tangential;
  };
  [[nodiscard]] Vector3 relative_motion(const TouchingPair& touched, int k,
                                        std::span<const double> shift) const;
  [[nodiscard]] ForceRates force_rates(const TouchingPair& touched, int k,
                                       std::span<const double> shift) const;
  [[nodiscard]] Vector3 node_motion(std::size_t node, int k) const;
  [[nodiscard]] Vector3 node_motion(std::size_t node, std::span<const double> shift) const;
  [[nodiscard]] Vector3 motion_of_point(std::size_t i, std::span<const double> shift) const;
};

void Twin::Implementation::reset(const Configuration& at, std::span<const Vector3> from) {
  kept_positions.assign(from.begin(), from.end());
  positions = kept_positions;
  std::fill(kept_anchors.begin(), kept_anchors.end(), FrictionAnchor{});
  forget(history);
  potential.forget();
  potential.forget_features();
  potential.keep_features(kept_features);
  foreseen = positions;
  tried_from = positions;
  kept_poses.clear();
  for (Obstacle& obstacle : obstacles) obstacle.X_WO_old.reset();
  shifts_known = false;
  given_up = false;
  friction_coefficient = 0.0;
  elapsed = 0.0;
  q = at;
  kept_q = q;
  place();
  keep_poses();
  begin({});
  potential.start_from(positions, Pose{});
  report_contact(*wearer, potential, contact);
}

/// Puts the device at q, with friction as it was at the end of the last frame.
void Twin::Implementation::place() {
  device->solid_pieces(q, pieces);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    obstacles[k].X_WO = pieces[k].X_FS;
    obstacles[k].friction_coefficient = friction_coefficient;
    if (!kept_poses.empty()) obstacles[k].X_WO_old = kept_poses[k];
  }
  std::copy(kept_anchors.begin(), kept_anchors.end(), anchors.begin());
}

void Twin::Implementation::keep_poses() {
  kept_poses.resize(pieces.size());
  for (std::size_t k = 0; k < pieces.size(); ++k) kept_poses[k] = pieces[k].X_FS;
}

/// Prepares the potential for an equilibrium; features are those that skin at `seen_positions`
/// sees, or where the last frame kept left it, or given as restored.
void Twin::Implementation::begin(std::span<const Vector3> seen_positions, bool features_given) {
  FingerPotential::Step step;
  step.old_positions = kept_positions;
  step.seen_positions = seen_positions;
  step.features_given = features_given;
  step.obstacles = obstacles;
  step.anchors = anchors;
  step.history = &history;
  step.elapsed = elapsed;
  potential.begin(step);
}

/// Moves the skin on as its equilibrium does from the last attempt to the device at `at`.
void Twin::Implementation::foresee(const Configuration& at) {
  foreseen = positions;
  for (std::size_t n = 0; n < foreseen.size(); ++n) {
    for (int k = 0; k < device->degrees_of_freedom(); ++k) {
      foreseen[n] += (at[k] - q[k]) * node_motion(n, k);
    }
  }
}

/// Evaluates where the skin is foreseen or, if that is far from balance and its energy is less
/// there, where it is.
void Twin::Implementation::start(bool was_foreseen) {
  if (!was_foreseen) {
    potential.start_from(positions, Pose{});
    return;
  }
  potential.start_from(foreseen, Pose{});
  if (potential.residual() < kNearBalance) return;
  const double energy = potential.energy();
  potential.start_from(positions, Pose{});
  if (energy < potential.energy()) potential.start_from(foreseen, Pose{});
}

TwinSummary Twin::Implementation::attempt(const Configuration& at, int most_iterations) {
  if (given_up) {
    positions = tried_from;
    q = tried_from_q;
    given_up = false;
  }
  if (most_iterations < Twin::kAsManyAsItTakes) {
    tried_from = positions;
    tried_from_q = q;
  }
  const bool was_foreseen = shifts_known && at != q;
  if (was_foreseen) foresee(at);
  q = at;
  // A piece may have changed its shape.
  potential.forget_sightings();
  potential.restore_features(kept_features);
  place();
  const Tolerances tolerances = tolerances_for(precision);
  NewtonOptions newton;
  newton.tolerance = tolerances.roughly;
  newton.stop = stop;
  TwinSummary summary;
  for (int pass = 0; pass < kFrictionPasses; ++pass) {
    newton.max_iterations = std::min(kIterations, most_iterations - summary.iterations);
    if (pass < kLooks) begin(pass == 0 ? std::span<const Vector3>{} : positions);
    if (pass == 0) {
      start(was_foreseen);
    } else {
      potential.renew();
    }
    const NewtonSummary solved = untangle_and_minimise(potential, newton);
    summary.iterations += solved.iterations;
    summary.converged = solved.converged;
    potential.settle();
    std::copy(potential.positions().begin(), potential.positions().end(), positions.begin());
    const double change = potential.contact().update_limits(anchors);
    const double little =
        std::max(tolerances.friction, tolerances.friction_part * potential.contact().force_norm());
    const bool stand = pass + 1 >= kLooks && change < little;
    const bool fully =
        newton.tolerance == tolerances.residual || solved.residual <= tolerances.residual;
    if (stand && fully) break;
    given_up = summary.iterations >= most_iterations;
    if (given_up) {
      summary.converged = false;
      break;
    }
    if (stand || pass + 2 == kFrictionPasses) newton.tolerance = tolerances.residual;
  }
  report_contact(*wearer, potential, contact);
  shifts_known = shifts_known && (given_up || contact.contact_count > 0);
  return summary;
}

void Twin::Implementation::keep() {
  kept_q = q;
  keep_poses();
  potential.keep_features(kept_features);
  std::copy(positions.begin(), positions.end(), kept_positions.begin());
  potential.elastic().end_step(potential.elastic_work(), elapsed, history);
  potential.contact().update_anchors(potential.contact_positions(), anchors);
  std::copy(anchors.begin(), anchors.end(), kept_anchors.begin());
  elapsed = 0.0;
}

void Twin::Implementation::find_touching(bool with_curvature) {
  touching.clear();
  TouchingPair pair;
  for (pair.point = 0; pair.point < potential.contact_positions().size(); ++pair.point) {
    for (pair.piece = 0; pair.piece < pieces.size(); ++pair.piece) {
      if (potential.contact().pair_response(pair.point, pair.piece, with_curvature,
                                            pair.response)) {
        touching.push_back(pair);
      }
    }
  }
}

/// How a touching pair moves against each other with component k while the skin moves by `shift`.
Vector3 Twin::Implementation::relative_motion(const TouchingPair& touched, int k,
                                              std::span<const double> shift) const {
  return motion_of_point(touched.point, shift) -
         motion(touched.piece, k)
             .at(potential.contact_positions()[touched.point], touched.response.outward);
}

/// By component k while the skin moves by `shift`.
Twin::Implementation::ForceRates Twin::Implementation::force_rates(
    const TouchingPair& touched, int k, std::span<const double> shift) const {
  const Vector3& spin = motion(touched.piece, k).spin;
  const ContactPotential::PairResponse& pair = touched.response;
  const Vector3 relative = relative_motion(touched, k, shift);
  // Both forces together are minus the gradient of the pair's energy.
  const Vector3 both = -spin.cross(pair.gradient) - (pair.hessian + pair.following) * relative;
  const Vector3 normal = spin.cross(pair.normal_force) - pair.normal_stiffness * relative;
  return {normal, both - normal};
}

/// Adds what pushes the skin as component k grows: the device's motion itself, or `rubbing`, the
/// friction limits and planes that follow the normal forces while the skin moves by `shift`.
void Twin::Implementation::add_push(int k, bool rubbing, std::span<const double> shift,
                                    std::span<double> push) const {
  const std::size_t samples = wearer->sample_nodes.size();
  const auto add = [&](int node, const Vector3& force) {
    const int block = potential.unknowns().block_of_node[static_cast<std::size_t>(node)];
    if (block >= 0) Eigen::Map<Vector3>(push.data() + 3 * block) += force;
  };
  const std::span<const Vector3> points = potential.contact_positions();
  for (const TouchingPair& touched : touching) {
    const ContactPotential::PairResponse& pair = touched.response;
    const PieceMotion& motion = this->motion(touched.piece, k);
    Vector3 force = Vector3::Zero();
    if (rubbing) {
      if (pair.following.isZero(0.0)) continue;
      force = -pair.following * relative_motion(touched, k, shift);
    } else if (motion.moves()) {
      force = pair.hessian * motion.at(points[touched.point], pair.outward) -
              motion.spin.cross(pair.gradient);
    } else {
      continue;
    }
    if (touched.point < samples) {
      add(wearer->sample_nodes[touched.point], force);
      continue;
    }
    const FeaturePoints::Point& feature = potential.features().points()[touched.point - samples];
    for (std::size_t c = 0; c < 3; ++c) add(feature.nodes[c], feature.weights[c] * force);
  }
}

/// How the skin's equilibrium moves by components first to end - 1: -A^-1 dG/dq.
void Twin::Implementation::drag_by(int first, int end) {
  while (first < end) {
    std::size_t count = 0;
    for (; count < drags.size() && first < end; ++first) {
      const bool pushes = std::ranges::any_of(
          touching, [&](const TouchingPair& pair) { return motion(pair.piece, first).moves(); });
      if (pushes) drags[count++].k = first;
    }
    drag_together({drags.data(), count});
  }
}

/// The part of dG/dx by which friction follows the normal forces is not symmetric and not in A: it
/// is iterated for.
void Twin::Implementation::drag_together(std::span<Drag> together) {
  const auto shift_of = [&](const Drag& drag) -> std::vector<double>& {
    return shifts[static_cast<std::size_t>(drag.k)];
  };
  std::array<std::span<double>, kDragsTogether> sides;
  for (std::size_t i = 0; i < together.size(); ++i) {
    std::vector<double>& shift = shift_of(together[i]);
    std::fill(shift.begin(), shift.end(), 0.0);
    add_push(together[i].k, false, {}, shift);
    std::copy(shift.begin(), shift.end(), together[i].pushed.begin());
    sides[i] = shift;
  }
  potential.solve_together({sides.data(), together.size()});
  const bool rubs = std::ranges::any_of(
      touching, [](const TouchingPair& t) { return !t.response.following.isZero(0.0); });
  for (int round = 0; rubs && round < kDragRounds && !together.empty(); ++round) {
    for (std::size_t i = 0; i < together.size(); ++i) {
      Drag& drag = together[i];
      std::copy(drag.pushed.begin(), drag.pushed.end(), drag.rubbed.begin());
      add_push(drag.k, true, shift_of(drag), drag.rubbed);
      sides[i] = drag.rubbed;
    }
    potential.solve_together({sides.data(), together.size()});
    for (Drag& drag : together) {
      std::vector<double>& shift = shift_of(drag);
      double change = 0.0;
      double size = 0.0;
      for (std::size_t n = 0; n < shift.size(); ++n) {
        change += (drag.rubbed[n] - shift[n]) * (drag.rubbed[n] - shift[n]);
        size += drag.rubbed[n] * drag.rubbed[n];
      }
      std::swap(shift, drag.rubbed);
      drag.settled = change <= kDragTolerance * kDragTolerance * size;
    }
    const auto settled = std::partition(together.begin(), together.end(),
                                        [](const Drag& drag) { return !drag.settled; });
    together = together.first(static_cast<std::size_t>(settled - together.begin()));
  }
}

/// What drag_by() found.
Vector3 Twin::Implementation::node_motion(std::size_t node, int k) const {
  return node_motion(node, shifts[static_cast<std::size_t>(k)]);
}

Vector3 Twin::Implementation::node_motion(std::size_t node, std::span<const double> shift) const {
  const int block = potential.unknowns().block_of_node[node];
  if (block < 0) return Vector3::Zero();
  return Eigen::Map<const Vector3>(shift.data() + 3 * block);
}

/// The same at contact point i.
Vector3 Twin::Implementation::motion_of_point(std::size_t i, std::span<const double> shift) const {
  const auto at = [&](int node) { return node_motion(static_cast<std::size_t>(node), shift); };
  const std::size_t samples = wearer->sample_nodes.size();
  if (i < samples) return at(wearer->sample_nodes[i]);
  const FeaturePoints::Point& feature = potential.features().points()[i - samples];
  Vector3 motion = Vector3::Zero();
  for (std::size_t c = 0; c < 3; ++c) motion += feature.weights[c] * at(feature.nodes[c]);
  return motion;
}

bool Twin::Implementation::forces_and_derivatives(TwinForces& forces) {
  const int dof = device->degrees_of_freedom();
  forces.normal_by_q.setZero(3, dof);
  forces.tangential_by_q.setZero(3, dof);
  for (std::vector<double>& shift : shifts) std::fill(shift.begin(), shift.end(), 0.0);
  find_touching(true);
  forces.normal.setZero();
  forces.tangential.setZero();
  for (const TouchingPair& pair : touching) {
    forces.normal += pair.response.normal_force;
    forces.tangential -= pair.response.gradient + pair.response.normal_force;
  }
  if (!(forces.normal.norm() > 0.0)) return true;
  if (!potential.factorise(HessianKind::kFull)) {
    if (!potential.factorise(HessianKind::kNoContactCurvature)) return false;
    find_touching(false);
  }
  motions.at(q);
  drag_by(0, dof);
  for (int k = 0; k < dof; ++k) {
    for (const TouchingPair& pair : touching) {
      const ForceRates rates = force_rates(pair, k, shifts[static_cast<std::size_t>(k)]);
      forces.normal_by_q.col(k) += rates.normal;
      forces.tangential_by_q.col(k) += rates.tangential;
    }
  }
  shifts_known = true;
  return true;
}

bool Twin::Implementation::force_by_mount(const Vector3& origin_F, Vector6& by_mount,
                                          Eigen::VectorXd& by_q) {
  const int dof = device->degrees_of_freedom();
  by_mount.setZero();
  by_q.setZero(dof);
  TwinForces forces;
  if (!forces_and_derivatives(forces)) return false;
  if (!(forces.normal.norm() > 0.0)) return true;
  const Vector3 along = forces.normal.normalized();
  by_q = forces.normal_by_q.transpose() * along;
  for (int c = 0; c < kMountMotions; ++c) {
    PieceMotion& moved = mount_motions[static_cast<std::size_t>(c)];
    moved = {.origin = origin_F};
    (c < 3 ? moved.velocity : moved.spin)[c % 3] = 1.0;
  }
  drag_by(dof, dof + kMountMotions);
  for (int c = 0; c < kMountMotions; ++c) {
    for (const TouchingPair& pair : touching) {
      const std::vector<double>& shift = shifts[static_cast<std::size_t>(dof + c)];
      by_mount[c] += along.dot(force_rates(pair, dof + c, shift).normal);
    }
  }
  return true;
}

/// Evaluates this twin where the other one's skin is, as much stretched from the one rest shape to
/// the other.
void Twin::Implementation::take_place_of(const Implementation& at) {
  const Vector3 scale = size_ratio(*at.wearer, *wearer);
  for (std::size_t n = 0; n < positions.size(); ++n) {
    kept_positions[n] = at.kept_positions[n].cwiseProduct(scale);
    positions[n] = at.positions[n].cwiseProduct(scale);
  }
  kept_anchors = at.kept_anchors;
  kept_poses = at.kept_poses;
  friction_coefficient = at.friction_coefficient;
  elapsed = at.elapsed;
  q = at.q;
  shifts_known = false;
  potential.forget_sightings();
  potential.restore_features(at.kept_features);
  place();
  anchors = at.anchors;
  // Looked for anew they might be others here than there.
  begin(positions, true);
  potential.start_from(positions, Pose{});
}

Vector3 Twin::Implementation::normal_force() const {
  Vector3 sum = Vector3::Zero();
  ContactPotential::PairResponse response;
  for (std::size_t i = 0; i < potential.contact_positions().size(); ++i) {
    for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
      if (potential.contact().pair_response(i, piece, false, response)) {
        sum += response.normal_force;
      }
    }
  }
  return sum;
}

bool Twin::Implementation::load_and_derivative(DeviceLoad& load) {
  const int dof = device->degrees_of_freedom();
  load.load.setZero(dof);
  load.by_q.setZero(dof, dof);
  TwinForces forces;
  const bool stable = forces_and_derivatives(forces);
  if (!(forces.normal.norm() > 0.0)) return stable;
  if (!stable) motions.at(q);
  for (const TouchingPair& pair : touching) {
    const Vector3& point = potential.contact_positions()[pair.point];
    const auto motion = [&](int k) {
      return motions(pair.piece, k).at(point, pair.response.outward);
    };
    for (int k = 0; k < dof; ++k) load.load[k] += motion(k).dot(pair.response.gradient);
    for (int l = 0; stable && l < dof; ++l) {
      const ForceRates rates = force_rates(pair, l, shifts[static_cast<std::size_t>(l)]);
      for (int k = 0; k < dof; ++k) {
        load.by_q(k, l) -= motion(k).dot(rates.normal + rates.tangential);
      }
    }
  }
  return stable;
}

Twin::Twin(std::shared_ptr<const FingerModel> wearer, std::shared_ptr<const Device> device,
           TwinPrecision precision)
    : implementation_(
          std::make_unique<Implementation>(std::move(wearer), std::move(device), precision)) {}
Twin::~Twin() = default;
Twin::Twin(Twin&&) noexcept = default;
Twin& Twin::operator=(Twin&&) noexcept = default;

void Twin::heed(const std::stop_token& stop) { implementation_->stop = stop; }
void Twin::reset() { reset(device().home()); }
void Twin::reset(const Configuration& q) { reset(q, wearer().mesh.nodes); }
void Twin::reset(const Configuration& q, std::span<const Vector3> positions) {
  implementation_->reset(q, positions);
}

TwinSummary Twin::press(const Configuration& q, double friction_coefficient, double elapsed) {
  Implementation& self = *implementation_;
  const Configuration from = self.kept_q;
  const double way = self.motions.longest(from, q);
  const int parts = std::clamp(static_cast<int>(std::ceil(way / kLongestPart)), 1, kMostParts);
  TwinSummary summary;
  for (int part = 1; part <= parts; ++part) {
    begin_frame(friction_coefficient, elapsed / parts);
    const TwinSummary one =
        attempt(part == parts ? q : Configuration(from + (q - from) * part / parts));
    summary.iterations += one.iterations;
    summary.converged = one.converged;
    keep();
  }
  return summary;
}

void Twin::begin_frame(double friction_coefficient, double elapsed) {
  implementation_->friction_coefficient = friction_coefficient;
  implementation_->elapsed = elapsed;
}
TwinSummary Twin::attempt(const Configuration& q, int most_iterations) {
  return implementation_->attempt(q, most_iterations);
}
void Twin::keep() { implementation_->keep(); }
void Twin::end_frame(const Configuration& q) {
  const Implementation& self = *implementation_;
  if (self.q == q && self.motions.longest(self.kept_q, q) <= kLongestPart) {
    keep();
  } else {
    press(q, self.friction_coefficient, self.elapsed);
  }
}

const Configuration& Twin::configuration() const { return implementation_->q; }
bool Twin::forces_and_derivatives(TwinForces& forces) {
  return implementation_->forces_and_derivatives(forces);
}
bool Twin::force_and_derivative(Vector3& force, SurfaceJacobian& by_q) {
  TwinForces forces;
  const bool stable = implementation_->forces_and_derivatives(forces);
  force = forces.normal;
  by_q = forces.normal_by_q;
  return stable;
}

bool Twin::load_and_derivative(DeviceLoad& load) {
  return implementation_->load_and_derivative(load);
}

bool Twin::force_by_mount(const Vector3& origin_F, Vector6& by_mount, Eigen::VectorXd& by_q) {
  return implementation_->force_by_mount(origin_F, by_mount, by_q);
}

double Twin::force_difference(Twin& same, Twin& other) const {
  const Implementation& self = *implementation_;
  if (self.touching.empty()) return 0.0;
  same.implementation_->take_place_of(self);
  other.implementation_->take_place_of(self);
  const std::span<const double> before = same.implementation_->potential.gradient();
  const std::span<const double> after = other.implementation_->potential.gradient();
  std::vector<double> shift(before.size());
  for (std::size_t i = 0; i < shift.size(); ++i) shift[i] = before[i] - after[i];
  self.potential.solve(shift);
  const Vector3 now = self.normal_force();
  Vector3 change = other.implementation_->normal_force() - same.implementation_->normal_force();
  for (const Implementation::TouchingPair& pair : self.touching) {
    change -= pair.response.normal_stiffness * self.motion_of_point(pair.point, shift);
  }
  return now.norm() > 0.0 ? change.dot(now.normalized()) : 0.0;
}

Vector3 Twin::node_motion(std::size_t node, int k) const {
  return implementation_->node_motion(node, k);
}

const FingerModel& Twin::wearer() const { return *implementation_->wearer; }
const Device& Twin::device() const { return *implementation_->device; }
const ContactSet& Twin::contact() const { return implementation_->contact; }
std::span<const Vector3> Twin::positions() const { return implementation_->positions; }

}  // namespace softfinger
