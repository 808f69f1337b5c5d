#include "softfinger/objectives/secant_forces.hpp"

namespace softfinger {
namespace {

constexpr double kForetold = 0.2;  // of the change of the normal force may come otherwise

}  // namespace

bool SecantForces::learn(const Device& device, const Configuration& step, const Vector3& normal,
                         const Vector3& tangential) {
  const auto squared_metric = [&](Eigen::Index k) {
    const double metric = device.axes()[static_cast<std::size_t>(k)].metric;
    return metric * metric;
  };
  const Vector3 change = normal - forces.normal;
  Vector3 normal_amiss = change;
  Vector3 tangential_amiss = tangential - forces.tangential;
  double squared_length = 0.0;
  for (Eigen::Index k = 0; k < step.size(); ++k) {
    normal_amiss -= step[k] * forces.normal_by_q.col(k);
    tangential_amiss -= step[k] * forces.tangential_by_q.col(k);
    squared_length += squared_metric(k) * step[k] * step[k];
  }
  for (Eigen::Index k = 0; k < step.size(); ++k) {
    const double part = squared_metric(k) * step[k] / squared_length;
    forces.normal_by_q.col(k) += part * normal_amiss;
    forces.tangential_by_q.col(k) += part * tangential_amiss;
  }
  const bool foretold = normal_amiss.norm() <= kForetold * change.norm();
  doubtful = doubtful || !foretold;
  return foretold;
}

}  // namespace softfinger
