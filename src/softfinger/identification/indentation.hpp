#pragma once

#include <functional>
#include <span>
#include <vector>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/geometry/signed_distance.hpp"

namespace softfinger {

/// A fixed obstacle the pad is pressed on; its frame O is placed in W with the finger.
struct Indenter {
  Shape shape = HalfSpace{};
  Vector3 p_FO_W = Vector3::Zero();  ///< where O lies under F's origin, x and y used, m
  /// Solid at x <= 0 only, seen from F: a box whose rounded edge runs along y.
  static Indenter plane();
  static Indenter ball(double radius, double at_x, double at_y);
  static Indenter edge(double edge_radius);
};

struct IndentationOptions {
  double depth = 2e-3;  ///< greatest bone displacement after first touch, m
  int rows = 20;
  /// Of an equilibrium, relative to its forces: tighter than of steps, since others recompute the
  /// balance from what is exported.
  double tolerance = 1e-9;
  double friction_tolerance =
      1e-7;            ///< N; lagged friction limits are renewed until they change less
  double pitch = 0.0;  ///< turn of the finger about its y axis, rad; positive: distal end down
  bool strain_limits = true;
  bool friction = true;
  double speed = 0.0;    ///< bone speed, m/s, the tissue's too before touch; 0: quasi-static
  double hold = 0.0;     ///< then s at the greatest depth, in as many rows again; needs a speed
  bool unload = false;   ///< then back to first touch, in as many rows again
  bool relaxed = false;  ///< long-time moduli; only quasi-static
};

/// One row: equilibrium at one depth.
struct IndentationRow {
  double indentation = 0.0;       ///< m
  double time = 0.0;              ///< s since first touch; 0 where quasi-static
  double normal_force = 0.0;      ///< N, as ContactSet's
  double normal_force_sum = 0.0;  ///< N, likewise
  double tangential_force = 0.0;  ///< N, likewise
  double contact_area = 0.0;      ///< m^2
  double slip_ratio = 0.0;        ///< see ContactSet
  double stuck_fraction = 0.0;
  int contact_samples = 0;
  double max_stretch = 1.0, min_stretch = 1.0;
  double volume_ratio = 1.0;
  int iterations = 0;
  double residual = 0.0;  ///< N, largest absolute force component on a free node
  bool converged = true;
};

/// State handed out with each row, for export.
struct IndentationState {
  const IndentationRow& row;
  std::span<const Vector3> positions;  ///< all nodes, W, m
  const ContactSet& contact;           ///< in F
  Pose X_WF;
  std::span<const int> patches;  ///< see ElasticModel::patch_of_tetrahedron
};

/// Presses the finger along -z of the world on a fixed obstacle, bone and nail prescribed, no
/// gravity. Calls `visit` after each row. Indentation counts from where the resting skin, as its
/// triangles have it, first touches. Throws InputError where the way down meets no skin.
void indent(const FingerModel& model, const Indenter& indenter, const IndentationOptions& options,
            const std::function<void(const IndentationState&)>& visit);

}  // namespace softfinger
