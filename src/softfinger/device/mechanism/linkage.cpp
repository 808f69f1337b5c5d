#include "softfinger/device/mechanism/linkage.hpp"

#include <bit>
#include <cmath>
#include <utility>

namespace softfinger {
namespace {

/// Inverse of the left Jacobian of the exponential: the rate of a rotation vector t is
/// inverse_left_jacobian(t) times the angular velocity. I - [t]/2 + c(|t|^2) [t]^2 (Bullo and
/// Murray, "Proportional derivative (PD) control on the Euclidean group", ECC 1995).
struct InverseLeftJacobian {
  explicit InverseLeftJacobian(const Vector3& t) : turn(skew(t)), vector(t) {
    const double s = t.squaredNorm();
    if (s < 0.25) {  // sum |B_2k| / (2k)! s^(k-1), B the Bernoulli numbers, by Horner's scheme
      static constexpr std::array<double, 7> kSeries{1.0 / 12.0,         1.0 / 720.0,
                                                     1.0 / 30240.0,      1.0 / 1209600.0,
                                                     1.0 / 47900160.0,   691.0 / 1307674368000.0,
                                                     1.0 / 74724249600.0};
      for (auto term = kSeries.rbegin(); term != kSeries.rend(); ++term) {
        c_rate = c_rate * s + c;
        c = c * s + *term;
      }
    } else {
      const double angle = std::sqrt(s);
      const double half = 0.5 * angle / std::tan(0.5 * angle);
      c = (1.0 - half) / s;
      const double sine = std::sin(0.5 * angle);
      const double half_rate = 0.25 * (half / (0.5 * s) - 0.5 / (sine * sine));
      c_rate = (-half_rate - c) / s;
    }
  }
  [[nodiscard]] Matrix3 matrix() const {
    return Matrix3::Identity() - 0.5 * turn + c * turn * turn;
  }
  /// Its rate for a rate of the rotation vector.
  [[nodiscard]] Matrix3 rate(const Vector3& vector_rate) const {
    const Matrix3 turn_rate = skew(vector_rate);
    return -0.5 * turn_rate + (2.0 * c_rate * vector.dot(vector_rate)) * turn * turn +
           c * (turn_rate * turn + turn * turn_rate);
  }

  Matrix3 turn;
  Vector3 vector;
  double c = 0.0, c_rate = 0.0;  ///< c_rate: by s = |t|^2
};

/// Rotation by an angle about a unit axis (Rodrigues).
Matrix3 hinged(const Vector3& axis, double angle) {
  const double sine = std::sin(angle);
  const double cosine = std::cos(angle);
  Matrix3 turn = (1.0 - cosine) * axis * axis.transpose();
  turn.diagonal().array() += cosine;
  return turn + sine * skew(axis);
}

Vector3 rotation_reading(const LinkageReading& reading, const LinkagePlacement& placement) {
  const Matrix3& rotation = placement.body[static_cast<std::size_t>(reading.body)].rotation;
  return log_rotation(rotation * reading.reference.rotation.transpose());
}

}  // namespace

int coordinate_count(JointType type) {
  switch (type) {
    case JointType::kFixed:
      return 0;
    case JointType::kRevolute:
    case JointType::kPrismatic:
      return 1;
    case JointType::kUniversal:
      return 2;
    case JointType::kSpherical:
      return 3;
    case JointType::kFree:
      break;
  }
  return 6;
}

Linkage::Linkage(const std::vector<LinkageBody>& bodies, std::vector<LoopEquation> equations,
                 double length)
    : bodies_{LinkageBody{}},
      equations_(std::move(equations)),
      length_(length),
      first_coordinate_{0},
      movers_{0} {
  bodies_.insert(bodies_.end(), bodies.begin(), bodies.end());
  for (int b = 1; b < body_count(); ++b) {
    const LinkageBody& body = bodies_[static_cast<std::size_t>(b)];
    first_coordinate_.push_back(static_cast<int>(spots_.size()));
    std::uint64_t movers = movers_[static_cast<std::size_t>(body.parent)];
    const int count = softfinger::coordinate_count(body.type);
    for (int k = 0; k < count; ++k) {
      movers |= std::uint64_t{1} << spots_.size();
      const bool slides =
          body.type == JointType::kPrismatic || (body.type == JointType::kFree && k < 3);
      spots_.push_back({b, !slides});
    }
    movers_.push_back(movers);
  }
}

void Linkage::place(const LinkageCoordinates& x, LinkagePlacement& placement) const {
  placement.body[0] = Pose{};
  for (std::size_t b = 1; b < bodies_.size(); ++b) {
    const LinkageBody& body = bodies_[b];
    const Pose X_BJ = placement.body[static_cast<std::size_t>(body.parent)] * body.X_PJ;
    const int first = first_coordinate_[b];
    const auto j = static_cast<std::size_t>(first);
    Pose& pose = placement.body[b];
    pose = X_BJ;
    switch (body.type) {
      case JointType::kFixed:
        break;
      case JointType::kRevolute:
        placement.direction[j] = X_BJ.rotation * body.axis;
        pose.rotation = X_BJ.rotation * hinged(body.axis, x[first]);
        break;
      case JointType::kPrismatic:
        placement.direction[j] = X_BJ.rotation * body.axis;
        pose.translation += x[first] * placement.direction[j];
        break;
      case JointType::kUniversal: {
        placement.direction[j] = X_BJ.rotation * body.axis;
        const Matrix3 turned = X_BJ.rotation * hinged(body.axis, x[first]);
        placement.direction[j + 1] = turned * body.second_axis;
        pose.rotation = turned * hinged(body.second_axis, x[first + 1]);
        break;
      }
      case JointType::kSpherical:
        for (std::size_t k = 0; k < 3; ++k) {
          placement.direction[j + k] = X_BJ.rotation.col(static_cast<Eigen::Index>(k));
        }
        pose.rotation = X_BJ.rotation * exp_rotation(x.segment<3>(first));
        break;
      case JointType::kFree:
        for (std::size_t k = 0; k < 3; ++k) {
          placement.direction[j + k] = X_BJ.rotation.col(static_cast<Eigen::Index>(k));
          placement.direction[j + 3 + k] = placement.direction[j + k];
        }
        pose.translation += X_BJ.rotation * x.segment<3>(first);
        pose.rotation = X_BJ.rotation * exp_rotation(x.segment<3>(first + 3));
        break;
    }
  }
}

void Linkage::move(LinkageCoordinates& x, const LinkageCoordinates& step) const {
  for (std::size_t b = 1; b < bodies_.size(); ++b) {
    const JointType type = bodies_[b].type;
    int first = first_coordinate_[b];
    if (type == JointType::kFree) {
      x.segment<3>(first) += step.segment<3>(first);
      first += 3;
    }
    if (type == JointType::kFree || type == JointType::kSpherical) {
      x.segment<3>(first) =
          log_rotation(exp_rotation(step.segment<3>(first)) * exp_rotation(x.segment<3>(first)));
    } else {
      const int count = softfinger::coordinate_count(type);
      for (int k = first; k < first + count; ++k) x[k] += step[k];
    }
  }
}

void Linkage::velocity(const LinkagePlacement& placement,
                       const Eigen::Ref<const Eigen::VectorXd>& rates,
                       LinkageVelocity& velocity) const {
  velocity.spin[0].setZero();
  velocity.velocity[0].setZero();
  for (std::size_t b = 1; b < bodies_.size(); ++b) {
    const auto parent = static_cast<std::size_t>(bodies_[b].parent);
    Vector3 spin = velocity.spin[parent];
    Vector3 shift = velocity.velocity[parent] +
                    spin.cross(placement.body[b].translation - placement.body[parent].translation);
    const Vector3 carrier = spin;
    const int first = first_coordinate_[b];
    const int count = softfinger::coordinate_count(bodies_[b].type);
    for (int k = first; k < first + count; ++k) {
      const auto j = static_cast<std::size_t>(k);
      // The second axis of a universal joint turns with the first; all others with the parent.
      const bool second = bodies_[b].type == JointType::kUniversal && k > first;
      velocity.direction_rate[j] = (second ? spin : carrier).cross(placement.direction[j]);
      (spots_[j].angular ? spin : shift) += rates[k] * placement.direction[j];
    }
    velocity.spin[b] = spin;
    velocity.velocity[b] = shift;
  }
}

double Linkage::residual(int e, const LinkagePlacement& placement) const {
  const LoopEquation& equation = equations_[static_cast<std::size_t>(e)];
  const Pose& A = placement.body[static_cast<std::size_t>(equation.a)];
  const Pose& B = placement.body[static_cast<std::size_t>(equation.b)];
  const Vector3 direction = A.rotation * equation.direction_a;
  if (equation.kind == LoopEquation::Kind::kAlong) {
    return direction.dot(B * equation.point_b - A * equation.point_a);
  }
  return length_ * direction.dot(B.rotation * equation.direction_b);
}

void Linkage::read(std::span<const LinkageReading> readings, const LinkageCoordinates& x,
                   const LinkagePlacement& placement, Eigen::Ref<Eigen::VectorXd> values) const {
  int turned = -1;  // of which body `turn` is
  Vector3 turn = Vector3::Zero();
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const LinkageReading& reading = readings[k];
    double& value = values[static_cast<Eigen::Index>(k)];
    switch (reading.kind) {
      case LinkageReading::Kind::kJoint:
        value = x[reading.component];
        break;
      case LinkageReading::Kind::kPosition:
        value =
            placement.body[static_cast<std::size_t>(reading.body)].translation[reading.component] -
            reading.reference.translation[reading.component];
        break;
      case LinkageReading::Kind::kRotation:
        if (reading.body != turned) turn = rotation_reading(reading, placement);
        turned = reading.body;
        value = turn[reading.component];
        break;
    }
  }
}

Vector3 Linkage::point_velocity(int j, const LinkagePlacement& placement,
                                const Vector3& p_B) const {
  const Spot& spot = spots_[static_cast<std::size_t>(j)];
  const Vector3& direction = placement.direction[static_cast<std::size_t>(j)];
  if (!spot.angular) return direction;
  return direction.cross(p_B - placement.body[static_cast<std::size_t>(spot.body)].translation);
}

Vector3 Linkage::point_velocity_rate(int j, const LinkagePlacement& placement,
                                     const LinkageVelocity& velocity, const Vector3& p_B,
                                     const Vector3& p_rate) const {
  const Spot& spot = spots_[static_cast<std::size_t>(j)];
  const auto body = static_cast<std::size_t>(spot.body);
  const Vector3& rate = velocity.direction_rate[static_cast<std::size_t>(j)];
  if (!spot.angular) return rate;
  return rate.cross(p_B - placement.body[body].translation) +
         placement.direction[static_cast<std::size_t>(j)].cross(p_rate - velocity.velocity[body]);
}

// An equation does not change when both its bodies move as one, so only coordinates that move one
// of them count; and a moving about b's attachment changes it as b moving the other way.
void Linkage::gradient(int e, const LinkagePlacement& placement, Eigen::Ref<Eigen::MatrixXd> rows,
                       int row) const {
  const LoopEquation& equation = equations_[static_cast<std::size_t>(e)];
  const Pose& A = placement.body[static_cast<std::size_t>(equation.a)];
  const Pose& B = placement.body[static_cast<std::size_t>(equation.b)];
  const Vector3 direction = A.rotation * equation.direction_a;
  const bool along = equation.kind == LoopEquation::Kind::kAlong;
  const Vector3 point = B * equation.point_b;
  const Vector3 turn = length_ * (B.rotation * equation.direction_b).cross(direction);
  for (std::uint64_t left = between(equation); left != 0; left &= left - 1) {
    const int j = std::countr_zero(left);
    const double change = along         ? direction.dot(point_velocity(j, placement, point))
                          : is_angle(j) ? turn.dot(placement.direction[static_cast<std::size_t>(j)])
                                        : 0.0;
    rows(row, j) = moves(j, equation.b) ? change : -change;
  }
}

void Linkage::gradient_rate(int e, const LinkagePlacement& placement,
                            const LinkageVelocity& velocity, Eigen::Ref<Eigen::MatrixXd> rows,
                            int row) const {
  const LoopEquation& equation = equations_[static_cast<std::size_t>(e)];
  const auto a = static_cast<std::size_t>(equation.a);
  const auto b = static_cast<std::size_t>(equation.b);
  const Pose& B = placement.body[b];
  const Vector3 direction = placement.body[a].rotation * equation.direction_a;
  const Vector3 direction_rate = velocity.spin[a].cross(direction);
  const bool along = equation.kind == LoopEquation::Kind::kAlong;
  const Vector3 arm = B.rotation * equation.point_b;
  const Vector3 point = B.translation + arm;
  const Vector3 point_rate = velocity.velocity[b] + velocity.spin[b].cross(arm);
  const Vector3 other = B.rotation * equation.direction_b;
  const Vector3 turn = length_ * other.cross(direction);
  const Vector3 turn_rate =
      length_ * (velocity.spin[b].cross(other).cross(direction) + other.cross(direction_rate));
  for (std::uint64_t left = between(equation); left != 0; left &= left - 1) {
    const int j = std::countr_zero(left);
    double change = 0.0;
    if (along) {
      change = direction_rate.dot(point_velocity(j, placement, point)) +
               direction.dot(point_velocity_rate(j, placement, velocity, point, point_rate));
    } else if (is_angle(j)) {
      change = turn_rate.dot(placement.direction[static_cast<std::size_t>(j)]) +
               turn.dot(velocity.direction_rate[static_cast<std::size_t>(j)]);
    }
    rows(row, j) = moves(j, equation.b) ? change : -change;
  }
}

void Linkage::gradients(std::span<const LinkageReading> readings, const LinkagePlacement& placement,
                        Eigen::Ref<Eigen::MatrixXd> rows, int row) const {
  int turned = -1;  // of which body `by_spin` is
  Matrix3 by_spin;
  for (const LinkageReading& reading : readings) {
    const auto body = static_cast<std::size_t>(reading.body);
    const int component = reading.component;
    if (reading.kind == LinkageReading::Kind::kJoint) {
      rows(row, component) = 1.0;
    } else if (reading.kind == LinkageReading::Kind::kPosition) {
      for (std::uint64_t left = movers(reading.body); left != 0; left &= left - 1) {
        const int j = std::countr_zero(left);
        rows(row, j) = point_velocity(j, placement, placement.body[body].translation)[component];
      }
    } else {
      if (reading.body != turned) {
        by_spin = InverseLeftJacobian(rotation_reading(reading, placement)).matrix();
      }
      turned = reading.body;
      for (std::uint64_t left = movers(reading.body); left != 0; left &= left - 1) {
        const int j = std::countr_zero(left);
        if (!is_angle(j)) continue;
        rows(row, j) = by_spin.row(component) * placement.direction[static_cast<std::size_t>(j)];
      }
    }
    ++row;
  }
}

void Linkage::gradient_rates(std::span<const LinkageReading> readings,
                             const LinkagePlacement& placement, const LinkageVelocity& velocity,
                             Eigen::Ref<Eigen::MatrixXd> rows, int row) const {
  int turned = -1;  // of which body the following are
  Matrix3 by_spin;
  Matrix3 by_spin_rate;
  for (const LinkageReading& reading : readings) {
    const auto body = static_cast<std::size_t>(reading.body);
    const int component = reading.component;
    if (reading.kind == LinkageReading::Kind::kPosition) {
      for (std::uint64_t left = movers(reading.body); left != 0; left &= left - 1) {
        const int j = std::countr_zero(left);
        rows(row, j) = point_velocity_rate(j, placement, velocity, placement.body[body].translation,
                                           velocity.velocity[body])[component];
      }
    } else if (reading.kind == LinkageReading::Kind::kRotation) {
      if (reading.body != turned) {
        const InverseLeftJacobian inverse(rotation_reading(reading, placement));
        by_spin = inverse.matrix();
        by_spin_rate = inverse.rate(by_spin * velocity.spin[body]);
      }
      turned = reading.body;
      for (std::uint64_t left = movers(reading.body); left != 0; left &= left - 1) {
        const int j = std::countr_zero(left);
        if (!is_angle(j)) continue;
        rows(row, j) =
            by_spin_rate.row(component).dot(placement.direction[static_cast<std::size_t>(j)]) +
            by_spin.row(component).dot(velocity.direction_rate[static_cast<std::size_t>(j)]);
      }
    }
    ++row;
  }
}

}  // namespace softfinger
