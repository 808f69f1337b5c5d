#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Capacity of a linkage; the base counts as a body.
inline constexpr int kMaxLinkageBodies = 25;
inline constexpr int kMaxLinkageCoordinates = 48;

enum class JointType { kFixed, kRevolute, kPrismatic, kUniversal, kSpherical, kFree };
/// How many coordinates a joint has.
[[nodiscard]] int coordinate_count(JointType type);

/// A body with the one joint of the spanning tree that carries it. Its frame L is the joint's frame
/// J where the joint's coordinates are 0.
struct LinkageBody {
  int parent = 0;  ///< an earlier body; 0 is the base
  JointType type = JointType::kFixed;
  Pose X_PJ;                        ///< joint frame on the parent
  Vector3 axis = Vector3::UnitZ();  ///< unit, in J
  Vector3 second_axis =
      Vector3::UnitX();  ///< of a universal joint, unit, in J, turned by the first
};

/// One scalar equation of a loop between bodies a and b, in metres: the attachment points agree
/// along a direction of a (kAlong), or a direction of a is perpendicular to one of b (kAcross).
struct LoopEquation {
  enum class Kind { kAlong, kAcross };
  Kind kind = Kind::kAlong;
  int a = 0, b = 0;
  Vector3 point_a = Vector3::Zero(), point_b = Vector3::Zero();  ///< attachment, each in its body
  Vector3 direction_a = Vector3::UnitX();                        ///< unit, in a
  Vector3 direction_b = Vector3::UnitX();                        ///< unit, in b; kAcross only
  int loop = 0;                                                  ///< of which loop of the file
};

/// Something to read off a linkage: a joint's coordinate, or a component of a body's position
/// (origin) or rotation vector in the base frame, relative to a reference pose.
struct LinkageReading {
  enum class Kind { kJoint, kPosition, kRotation };
  Kind kind = Kind::kJoint;
  int body = 0;       ///< kPosition, kRotation
  int component = 0;  ///< 0..2 of the body; index of the coordinate for kJoint
  Pose reference;     ///< X_BL where the reading is 0
};

/// Coordinates of the tree's joints, rad and m; those of spherical and free joints hold rotation
/// vectors.
using LinkageCoordinates =
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxLinkageCoordinates, 1>;

/// Where everything is at some coordinates, in the base frame.
struct LinkagePlacement {
  std::array<Pose, kMaxLinkageBodies> body;               ///< X_BL
  std::array<Vector3, kMaxLinkageCoordinates> direction;  ///< axis turned or moved along, unit
};

/// How it moves for given rates of the coordinates.
struct LinkageVelocity {
  std::array<Vector3, kMaxLinkageBodies> spin;      ///< angular velocity
  std::array<Vector3, kMaxLinkageBodies> velocity;  ///< of the body's origin
  std::array<Vector3, kMaxLinkageCoordinates> direction_rate;
};

/// Rigid bodies joined to a tree, and the equations that close its loops. Rates of coordinates are
/// those of the joints, where rotation vectors change by the angular velocity in the joint's frame:
/// so nothing is singular, and all derivatives are those of geometry (Featherstone, "Rigid Body
/// Dynamics Algorithms", 2008, chapters 4 and 8). Immutable; queries neither allocate nor throw.
class Linkage {
 public:
  /// Bodies 1.. in an order where parents come first; body 0, the base, is added here. `length` (m)
  /// makes rotations comparable with lengths.
  Linkage(const std::vector<LinkageBody>& bodies, std::vector<LoopEquation> equations,
          double length);

  [[nodiscard]] int body_count() const { return static_cast<int>(bodies_.size()); }
  [[nodiscard]] int coordinate_count() const { return static_cast<int>(spots_.size()); }
  [[nodiscard]] int equation_count() const { return static_cast<int>(equations_.size()); }
  [[nodiscard]] const LinkageBody& body(int b) const {
    return bodies_[static_cast<std::size_t>(b)];
  }
  [[nodiscard]] const LoopEquation& equation(int e) const {
    return equations_[static_cast<std::size_t>(e)];
  }
  [[nodiscard]] double length() const { return length_; }
  /// First coordinate of the joint that carries body b.
  [[nodiscard]] int first_coordinate(int b) const {
    return first_coordinate_[static_cast<std::size_t>(b)];
  }
  /// Whether coordinate j is an angle.
  [[nodiscard]] bool is_angle(int j) const { return spots_[static_cast<std::size_t>(j)].angular; }
  [[nodiscard]] bool is_angle(const LinkageReading& reading) const {
    return reading.kind == LinkageReading::Kind::kRotation ||
           (reading.kind == LinkageReading::Kind::kJoint && is_angle(reading.component));
  }
  /// Whether coordinate j moves body b.
  [[nodiscard]] bool moves(int j, int b) const {
    return (movers_[static_cast<std::size_t>(b)] >> j & 1) != 0;
  }

  void place(const LinkageCoordinates& x, LinkagePlacement& placement) const;
  /// x after its joints moved by `step`, a rate times a time.
  void move(LinkageCoordinates& x, const LinkageCoordinates& step) const;
  void velocity(const LinkagePlacement& placement, const Eigen::Ref<const Eigen::VectorXd>& rates,
                LinkageVelocity& velocity) const;

  /// What equation e lacks of being closed, m.
  [[nodiscard]] double residual(int e, const LinkagePlacement& placement) const;
  void read(std::span<const LinkageReading> readings, const LinkageCoordinates& x,
            const LinkagePlacement& placement, Eigen::Ref<Eigen::VectorXd> values) const;

  // Derivatives by the coordinates, one an equation or reading, into row `row` and the following,
  // which are zero before; and how those change with the velocity.
  void gradient(int e, const LinkagePlacement& placement, Eigen::Ref<Eigen::MatrixXd> rows,
                int row) const;
  void gradient_rate(int e, const LinkagePlacement& placement, const LinkageVelocity& velocity,
                     Eigen::Ref<Eigen::MatrixXd> rows, int row) const;
  void gradients(std::span<const LinkageReading> readings, const LinkagePlacement& placement,
                 Eigen::Ref<Eigen::MatrixXd> rows, int row) const;
  void gradient_rates(std::span<const LinkageReading> readings, const LinkagePlacement& placement,
                      const LinkageVelocity& velocity, Eigen::Ref<Eigen::MatrixXd> rows,
                      int row) const;

  /// Velocity of the body-fixed point at p_B when coordinate j, which moves the body, has rate 1.
  [[nodiscard]] Vector3 point_velocity(int j, const LinkagePlacement& placement,
                                       const Vector3& p_B) const;
  /// How that changes while the point itself moves.
  [[nodiscard]] Vector3 point_velocity_rate(int j, const LinkagePlacement& placement,
                                            const LinkageVelocity& velocity, const Vector3& p_B,
                                            const Vector3& p_rate) const;

 private:
  /// Bits of the coordinates that move one of the two bodies but not the other.
  [[nodiscard]] std::uint64_t between(const LoopEquation& equation) const {
    return movers_[static_cast<std::size_t>(equation.a)] ^
           movers_[static_cast<std::size_t>(equation.b)];
  }
  [[nodiscard]] std::uint64_t movers(int body) const {
    return movers_[static_cast<std::size_t>(body)];
  }

  /// Where a coordinate acts.
  struct Spot {
    int body;
    bool angular;
  };

  std::vector<LinkageBody> bodies_;
  std::vector<LoopEquation> equations_;
  double length_;
  std::vector<Spot> spots_;            ///< one a coordinate
  std::vector<int> first_coordinate_;  ///< one a body
  std::vector<std::uint64_t> movers_;  ///< one a body: bit j: coordinate j moves it
};

}  // namespace softfinger
