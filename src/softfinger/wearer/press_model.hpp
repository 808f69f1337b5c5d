#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "softfinger/twin/twin.hpp"
#include "softfinger/wearer/press_reading.hpp"
#include "softfinger/wearer/wearer_traits.hpp"

namespace softfinger {

/// A predicted force and how it changes.
struct PredictedForce {
  double force = 0.0;                          ///< N
  TraitVector by_trait = TraitVector::Zero();  ///< N a standard deviation
  double by_advance = 0.0;                     ///< N/m
};

/// What presses are felt as by a finger with given traits: a twin in the device as the traits have
/// it. Forces at an equilibrium come with their derivatives: those by the mount are the derivatives
/// of a rigid motion of the device, those by sizes and modulus take one more solve each with the
/// factor of the equilibrium, of how far the skin stretched to the other rest shape is out of
/// balance.
class PressModel {
 public:
  /// `finger` and `device` as their files have them, `device` as it sits on that finger;
  /// `device_file` for messages. `friction_coefficient` of device on skin.
  PressModel(const std::shared_ptr<const FingerModel>& finger, std::shared_ptr<const Device> device,
             std::filesystem::path device_file, double friction_coefficient);

  /// From now on with these traits.
  void put(const TraitVector& x);
  /// The forces at these configurations of one press, without friction. `with_derivatives`: else
  /// only forces.
  [[nodiscard]] std::vector<PredictedForce> press(const Configuration& start,
                                                  std::span<const Configuration> path,
                                                  bool with_derivatives = true);
  /// The forces with friction, as the device goes along this way.
  [[nodiscard]] std::vector<double> press_with_friction(const Configuration& start,
                                                        std::span<const Configuration> path);
  /// How far `from` has to be advanced (m) for this force, and what that is with the derivatives of
  /// the force there. False where it is not reached within `most` (m).
  [[nodiscard]] bool advance_for(const Configuration& from, double force, double most,
                                 double& advance, PredictedForce& there);

  [[nodiscard]] const FingerModel& finger() const { return *finger_; }
  [[nodiscard]] const Device& device() const { return *device_; }
  /// With the traits.
  [[nodiscard]] const std::shared_ptr<const FingerModel>& worn_finger() const { return worn_; }
  [[nodiscard]] const std::shared_ptr<const Device>& worn_device() const { return mounted_; }

 private:
  void settle_at(const Configuration& q);
  [[nodiscard]] PredictedForce felt(bool with_derivatives);

  std::shared_ptr<const FingerModel> finger_, worn_;
  std::shared_ptr<const Device> device_, mounted_;
  std::filesystem::path device_file_;
  double friction_coefficient_;
  Eigen::Matrix<double, 6, kWearerTraits> mount_motion_;
  std::unique_ptr<Twin> twin_, same_;
  struct Other {
    WearerTrait trait;
    std::unique_ptr<Twin> twin;
  };
  std::vector<Other> others_;  ///< by each trait of the tissue a little different
};

}  // namespace softfinger
