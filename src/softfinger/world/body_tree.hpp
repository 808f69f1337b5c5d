#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "softfinger/contact/virtual_object.hpp"
#include "softfinger/finger/obstacle_coupling.hpp"

namespace softfinger {

/// Mass moments of a rigid object.
struct BodyInertia {
  double mass = 0.0;                   ///< kg
  Vector3 centre_O = Vector3::Zero();  ///< of mass, m
  Matrix3 second_O = Matrix3::Zero();  ///< sum m x x^T about the centre, kg m^2
};

/// What a slider (kg) or hinge (kg m^2) moves of its own object.
[[nodiscard]] double inertia_about(const Joint& joint, const BodyInertia& inertia);

/// An object that moves by the forces on it, and what it hangs on.
struct Body {
  std::size_t object = 0;  ///< its number in the scene
  BodyInertia inertia;
  std::optional<Joint> joint;  ///< absent: free
  int parent = -1;             ///< the body that it hangs on; -1: something that forces do not move
  bool stands_still = true;    ///< what it hangs on, where that is no body
  Pose X_PO;                   ///< where it is on its parent object, or in W, at q = 0
  int first = 0;               ///< of its coordinates among those of all
  int freedoms = 6;
};

/// Where a body is.
struct BodyPlace {
  Pose X_WO;
  double q = 0.0;                      ///< of slider (m) and hinge (rad)
  Matrix3 turn = Matrix3::Identity();  ///< of ball, in the frame where q = 0
};

/// Objects that move, as coordinates that hold their joints exactly: trees of sliders (along the
/// axis), hinges (about the axis), balls (rotation in W) and fixed joints, rooted in the world, in
/// an object that follows a script, or in a free body (translation of the centre of mass, rotation
/// about it, both in W).
class BodyTree {
 public:
  /// All that have dynamics; parents come before children. Throws InputError where joints make a
  /// loop, or a shape has no volume.
  explicit BodyTree(std::span<const VirtualObject> objects);

  [[nodiscard]] std::span<const Body> bodies() const { return bodies_; }
  [[nodiscard]] int freedoms() const { return freedoms_; }
  [[nodiscard]] const std::string& name(std::size_t object) const { return objects_[object].name; }
  /// The body that is this object; -1: it follows its script.
  [[nodiscard]] int body_of(std::size_t object) const { return body_of_object_[object]; }

  /// What pulls a body that is a bone of a hand; empty: it is none.
  [[nodiscard]] const std::optional<Following>& following(std::size_t body) const {
    return objects_[bodies_[body].object].dynamics->following;
  }

  /// Where bodies stand at the start, one a body.
  [[nodiscard]] std::vector<BodyPlace> start() const;
  /// All of them, in order.
  [[nodiscard]] std::span<const std::size_t> all() const { return all_; }
  /// These bodies, in order and each with what it hangs on, from `from` along `direction` (one a
  /// coordinate of all), with what follows a script where it is at `time`, s.
  void advance(std::span<const std::size_t> which, std::span<const BodyPlace> from,
               std::span<const double> direction, double t, double time,
               std::span<BodyPlace> to) const;
  /// Of a body with its joint at q or `turn`, and its parent in `places`.
  void put_on_parent(std::size_t body, double time, std::span<BodyPlace> places) const;

  /// How a body moves by one coordinate: translation of O's origin and rotation, W.
  struct Column {
    int coordinate = 0;
    Vector6 twist;
  };
  /// Of these bodies, as for advance(): by its own coordinates and those of all it hangs on, as the
  /// bodies stand at `places`. At most kMostColumns.
  static constexpr std::size_t kMostColumns = 24;
  struct Columns {
    std::array<Column, kMostColumns> columns;
    std::size_t count = 0;
    [[nodiscard]] std::span<const Column> all() const { return {columns.data(), count}; }
  };
  void columns(std::span<const std::size_t> which, std::span<const BodyPlace> places, double time,
               std::span<Columns> out) const;

  [[nodiscard]] Vector3 centre(std::size_t body, const Pose& X_WO) const {
    return X_WO * bodies_[body].inertia.centre_O;
  }

 private:
  [[nodiscard]] Pose parent_pose(const Body& body, std::span<const BodyPlace> places,
                                 double time) const;

  std::span<const VirtualObject> objects_;
  std::vector<Body> bodies_;
  std::vector<std::size_t> all_;
  std::vector<int> body_of_object_;
  int freedoms_ = 0;
};

}  // namespace softfinger
