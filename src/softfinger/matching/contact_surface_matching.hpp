#pragma once

#include <bitset>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// How the device's limits enter: as constraints of the optimisation; by cutting the joint angles
/// of the unlimited optimum afterwards (Perez et al. 2015); not at all.
enum class MatchingLimits { kInside, kClamp, kNone };
/// Separation asked of samples not in contact: eps for all (Perez et al. 2015), or
/// max(0, min(eps, gap)) with the gap each has in the virtual scene.
enum class Separation { kConstant, kScene };
enum class MatchingWeights { kUniform, kArea };

/// The skin as matching sees it. Views; lengths agree.
struct ContactPoints {
  std::span<const Vector3> points_F;         ///< m
  std::span<const std::uint8_t> in_contact;  ///< 1: member of C
  std::span<const double> areas;             ///< m^2; may be empty unless weights are kArea
  std::span<const double> gaps;              ///< virtual gaps, m; may be empty unless kScene
  std::span<const double> shares;  ///< by which each counts, 0 to 1; may be empty: all by 1
};

struct MatchingOptions {
  MatchingLimits limits = MatchingLimits::kInside;
  Separation separation = Separation::kScene;
  MatchingWeights weights = MatchingWeights::kUniform;
  std::optional<double> separation_tolerance;  ///< eps, m; the device's where empty
  int iteration_limit = 60;                    ///< per start
};

enum class Termination { kConverged, kIterationLimit, kNonsmooth };
[[nodiscard]] std::string_view to_string(Termination termination);

/// Bit k: constraint k of the device. Two for each degree of freedom, or fewer than 64.
using ConstraintSet = std::bitset<2 * kMaxDegreesOfFreedom>;

struct MatchingResult {
  Configuration configuration;
  JointAngles joints;         ///< meaningless unless joints_exist
  bool joints_exist = false;  ///< always true for limits inside and clamp
  double deviation = 0.0;     ///< E at configuration, m^2
  int iterations = 0;         ///< of all starts together
  Termination termination = Termination::kConverged;
  ConstraintSet active_constraints;
};

/// Contact surface matching: the device configuration whose surface touches the samples in contact
/// and no others (Perez et al. 2015, eq. 1). Newton's method on E with exact derivatives; limits as
/// constraints by sequential quadratic programming with feasible iterates. Fields of pins go one by
/// one instead, see PinMinimiser. solve() does not allocate.
class ContactSurfaceMatching {
 public:
  /// `capacity`: most samples a solve may bring.
  ContactSurfaceMatching(std::shared_ptr<const Device> device, int capacity);
  ~ContactSurfaceMatching();
  ContactSurfaceMatching(ContactSurfaceMatching&&) noexcept;
  ContactSurfaceMatching& operator=(ContactSurfaceMatching&&) noexcept;

  /// `warm`: where to start besides home, usually the last result; may be null. Of several
  /// minimisers the one nearest home in the metric of the device's axes. More samples than the
  /// capacity: the rest is ignored.
  [[nodiscard]] MatchingResult solve(const ContactPoints& points, const MatchingOptions& options,
                                     const Configuration* warm = nullptr);
  /// E at q, m^2. Does not allocate.
  [[nodiscard]] double deviation(const ContactPoints& points, const MatchingOptions& options,
                                 const Configuration& q);
  /// What q comes to, wherever it is from: brought into the workspace where limits are kClamp, with
  /// its joints, the limits it is at and E there, but no iterations. Does not allocate.
  [[nodiscard]] MatchingResult answer(const ContactPoints& points, const MatchingOptions& options,
                                      const Configuration& q);
  /// q advanced, nothing else changed, to where E is least; q itself where the device does not
  /// advance or nothing is in contact. Does not allocate.
  [[nodiscard]] Configuration advanced(const ContactPoints& points, const MatchingOptions& options,
                                       const Configuration& q);
  [[nodiscard]] const Device& device() const;
  /// Names for MatchingResult::active_constraints, each once: "joint_1" or configuration names.
  [[nodiscard]] std::vector<std::string> limit_names(const MatchingResult& result) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
