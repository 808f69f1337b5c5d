#include "softfinger/matching/surface_following.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"
#include "softfinger/matching/limit_clamp.hpp"
#include "softfinger/matching/skin_clearance.hpp"
#include "softfinger/matching/skin_points.hpp"

namespace softfinger {
namespace {

constexpr int kTicksOnSkin = 2;      // without contact, before the device leaves the skin
constexpr double kTurn = 6.0 * deg;  // a nearest normal that turns more in one tick is a jump

double shrunk(double value, double by) {
  return value > by ? value - by : (value < -by ? value + by : 0.0);
}

}  // namespace

struct SurfaceFollowing::Implementation {
  Implementation(std::shared_ptr<const Device> the_device, int capacity,
                 const MatchingOptions& the_options)
      : device(the_device),
        options(the_options),
        rates(device->settings().matching.easing),
        matching(std::move(the_device), capacity + static_cast<int>(ContactSet::kMostFeatures)),
        skin(*device, capacity),
        points(capacity) {
    reset();
  }

  std::shared_ptr<const Device> device;
  MatchingOptions options;
  EasingRates rates;
  ContactSurfaceMatching matching;
  SkinClearance skin;
  SkinPoints points;
  RenderedSurface rendered;

  int ticks_without_contact = 0;
  Configuration matched;           ///< last match, the next one's start
  Configuration followed, motion;  ///< see follow()
  bool following = false;
  // Off the skin the device is led by its orientation and its gap to the skin.
  Configuration air_target;  ///< orientation asked for at the last tick
  Configuration air_easing;  ///< orientation rendered minus asked for, shrinking
  double gap_easing = 0.0;   ///< gap rendered minus asked for, m, shrinking

  void reset();
  [[nodiscard]] bool turns(int axis) const;
  void touch(const ContactSet& contact, double elapsed);
  [[nodiscard]] Configuration eased_on_skin(const ContactPoints& view, double elapsed);
  void follow(const ContactSet& contact);
  [[nodiscard]] double turn(const Configuration& a, const Configuration& b) const;
  void stay_off(const ContactSet& contact, RenderingState state, double elapsed);
  [[nodiscard]] Configuration off_skin(const Configuration& orientation, double gap) const;
  void render(const Configuration& wanted, const Configuration& safe);
};

void SurfaceFollowing::Implementation::reset() {
  const Configuration none = Configuration::Zero(device->degrees_of_freedom());
  rendered = {};
  rendered.configuration = device->home();
  static_cast<void>(device->inverse_kinematics(device->home(), rendered.joints));
  ticks_without_contact = 0;
  matched = device->home();
  followed = device->home();
  motion = none;
  following = false;
  air_target = device->home();
  air_easing = none;
  gap_easing = 0.0;
}

bool SurfaceFollowing::Implementation::turns(int axis) const {
  return device->axes()[static_cast<std::size_t>(axis)].angular;
}

/// Renders `wanted` cut to the limits of the axes, or what of it is reachable on the way from
/// `safe`, which is.
void SurfaceFollowing::Implementation::render(const Configuration& wanted,
                                              const Configuration& safe) {
  Configuration cut = wanted;
  for (int k = 0; k < cut.size(); ++k) {
    const ConfigurationAxis& axis = device->axes()[static_cast<std::size_t>(k)];
    cut[k] = std::clamp(cut[k], axis.min, axis.max);
  }
  rendered.configuration = device->reachable(cut) ? cut : last_reachable(*device, safe, cut);
  static_cast<void>(device->inverse_kinematics(rendered.configuration, rendered.joints));
}

/// The pose with this orientation and gap to the skin.
Configuration SurfaceFollowing::Implementation::off_skin(const Configuration& orientation,
                                                         double gap) const {
  Configuration start = orientation;
  const int axis = device->approach_axis();
  if (axis >= 0) start[axis] = rendered.configuration[axis];
  return skin.with_gap(start, gap);
}

void SurfaceFollowing::Implementation::touch(const ContactSet& contact, double elapsed) {
  const ContactPoints view = points.take(contact);
  const MatchingResult result = matching.solve(view, options, &matched);
  matched = result.configuration;
  rendered.iterations = result.iterations;
  rendered.termination = result.termination;
  rendered.state = RenderingState::kTouching;
  render(eased_on_skin(view, elapsed), matched);
  rendered.deviation = rendered.configuration == matched
                           ? result.deviation
                           : matching.deviation(view, options, rendered.configuration);
}

/// The match, turned no further from what was rendered than the object turned against the bone and
/// an easing allows, and as far advanced as E is then least. A surface that is still off the skin
/// may turn as far as its gap is wide.
Configuration SurfaceFollowing::Implementation::eased_on_skin(const ContactPoints& view,
                                                              double elapsed) {
  if (!device->advances()) return matched;
  const double air = std::max(0.0, skin.gap(rendered.configuration));
  Configuration wanted = matched;
  for (int k = 0; k < matched.size(); ++k) {
    if (!turns(k)) continue;
    const double from = rendered.configuration[k];
    const double room =
        rates.turn_on_skin * elapsed + air / device->axes()[static_cast<std::size_t>(k)].metric;
    wanted[k] = std::clamp(matched[k], from + std::min(0.0, motion[k]) - room,
                           from + std::max(0.0, motion[k]) + room);
  }
  return wanted == matched ? matched : matching.advanced(view, options, wanted);
}

/// How the object moved against the bone since the last tick, as a device that faces its nearest
/// normal at its least gap would see it; zero where there was none or the normal jumped.
void SurfaceFollowing::Implementation::follow(const ContactSet& contact) {
  const bool had = following;
  const Configuration before = followed;
  motion.setZero();
  following = device->advances() && std::isfinite(contact.least_gap) &&
              contact.least_gap < 2.0 * device->settings().matching.approach;
  if (!following) return;
  followed = off_skin(device->facing(contact.nearest_normal_F, device->home()), contact.least_gap);
  if (had && turn(before, followed) <= kTurn) motion = followed - before;
}

/// How far two configurations are turned against each other, rad.
double SurfaceFollowing::Implementation::turn(const Configuration& a,
                                              const Configuration& b) const {
  double square = 0.0;
  for (int k = 0; k < a.size(); ++k) {
    if (!device->axes()[static_cast<std::size_t>(k)].angular) continue;
    square += (a[k] - b[k]) * (a[k] - b[k]);
  }
  return std::sqrt(square);
}

void SurfaceFollowing::Implementation::stay_off(const ContactSet& contact, RenderingState state,
                                                double elapsed) {
  const Configuration& home = device->home();
  const int approach = device->approach_axis();
  const double eps =
      options.separation_tolerance.value_or(device->settings().matching.separation_tolerance);
  rendered.deviation = 0.0;
  rendered.iterations = 0;
  rendered.termination = Termination::kConverged;

  // What is asked for, without easing.
  Configuration rest = home;
  if (skin.gap(home) < eps) {
    MatchingOptions clearing = options;
    clearing.separation = Separation::kConstant;
    const MatchingResult result = matching.solve(points.take(contact, false), clearing, &home);
    rest = result.configuration;
    rendered.iterations = result.iterations;
  }
  Configuration target = rest;
  double gap = skin.gap(rest);
  if (!device->advances()) {  // nothing to lead along: rest
    render(rest, home);
    rendered.state = state;
    return;
  }
  if (state != RenderingState::kHome) {
    target = device->facing(contact.nearest_normal_F, home);
    gap = state == RenderingState::kLingering ? 0.0 : std::max(0.0, contact.least_gap);
  }

  // What jumps between the last tick and this one is eased.
  const RenderingState before = rendered.state;
  const bool jump = before != state || turn(target, air_target) > kTurn;
  const bool arrived_here = before == RenderingState::kTouching;
  for (int k = 0; k < home.size(); ++k) {
    if (k == approach) continue;
    if (arrived_here) {
      air_easing[k] = rendered.configuration[k] - target[k];
    } else if (jump) {
      air_easing[k] += air_target[k] - target[k];
    }
    const bool on_skin = arrived_here || state == RenderingState::kLingering;
    const double rate =
        !turns(k) ? rates.move_off_skin : (on_skin ? rates.turn_on_skin : rates.turn_off_skin);
    air_easing[k] = shrunk(air_easing[k], rate * elapsed);
  }
  if (before != state) gap_easing = skin.gap(rendered.configuration) - gap;
  gap_easing = shrunk(gap_easing, rates.move_off_skin * elapsed);
  // It comes no nearer than it stands or is asked to, and presses nothing.
  const double standing = std::max(0.0, skin.gap(rendered.configuration));
  gap_easing = std::max(gap_easing, std::min(0.0, standing - gap));
  air_target = target;

  Configuration orientation = target;
  bool eased = gap_easing != 0.0;
  for (int k = 0; k < home.size(); ++k) {
    if (k == approach) continue;
    orientation[k] += air_easing[k];
    eased = eased || air_easing[k] != 0.0;
  }
  if (state == RenderingState::kHome && !eased) {
    render(rest, home);
  } else {
    render(off_skin(orientation, gap + gap_easing), home);
  }
  rendered.state = state;
}

SurfaceFollowing::SurfaceFollowing(std::shared_ptr<const Device> device, int capacity,
                                   MatchingOptions options)
    : implementation_(std::make_unique<Implementation>(std::move(device), capacity, options)) {}
SurfaceFollowing::~SurfaceFollowing() = default;
SurfaceFollowing::SurfaceFollowing(SurfaceFollowing&&) noexcept = default;
SurfaceFollowing& SurfaceFollowing::operator=(SurfaceFollowing&&) noexcept = default;

void SurfaceFollowing::reset() { implementation_->reset(); }

const RenderedSurface& SurfaceFollowing::tick(const ContactSet& contact, double elapsed) {
  Implementation& self = *implementation_;
  self.skin.take(contact);
  self.follow(contact);
  const bool was_on_skin = self.rendered.state == RenderingState::kTouching ||
                           self.rendered.state == RenderingState::kLingering;
  if (contact.contact_count > 0) {
    self.ticks_without_contact = 0;
    self.touch(contact, elapsed);
  } else if (was_on_skin && ++self.ticks_without_contact <= kTicksOnSkin) {
    self.stay_off(contact, RenderingState::kLingering, elapsed);
  } else if (contact.least_gap < self.device->settings().matching.approach) {
    self.stay_off(contact, RenderingState::kApproaching, elapsed);
  } else {
    self.stay_off(contact, RenderingState::kHome, elapsed);
  }
  return self.rendered;
}

const RenderedSurface& SurfaceFollowing::latest() const { return implementation_->rendered; }

const Device& SurfaceFollowing::device() const { return *implementation_->device; }

}  // namespace softfinger
