#pragma once

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

/// Where the skin was along one press: with traits that are hardly different it is found soon from
/// there.
struct PressedSkin {
  TraitVector x = TraitVector::Zero();
  std::shared_ptr<const FingerModel> finger;
  std::vector<std::vector<Vector3>> positions;  ///< of its nodes by configuration; empty: unpressed
};

/// Where a device that advances is felt with a given force.
struct ReachedForce {
  double advance = 0.0;  ///< m; below 0: taken back
  PredictedForce there;  ///< with derivatives
  PressedSkin skin;
};

/// What presses are felt as by a finger with given traits: a twin in the device as the traits have
/// it. Forces at an equilibrium come with their derivatives: those by the mount are the derivatives
/// of a rigid motion of the device, those by sizes and modulus take one more solve each with the
/// factor of the equilibrium, of how far the skin stretched to the other rest shape is out of
/// balance.
class PressModel {
 public:
  /// `finger` and `device` as their files have them, `device` as it sits on that finger;
  /// `friction_coefficient` of device on skin.
  PressModel(const std::shared_ptr<const FingerModel>& finger, std::shared_ptr<const Device> device,
             double friction_coefficient, TwinPrecision precision = TwinPrecision::kSearching);

  /// From now on with these traits.
  void put(const TraitVector& x);
  /// The forces at these configurations of one press, without friction. `with_derivatives`: else
  /// only forces. From where it is more, or the skin is pressed so far that no equilibrium is
  /// found, they are kUnbearable, without derivatives. `skin`: of the same press, where it was and
  /// now is.
  [[nodiscard]] std::vector<PredictedForce> press(const Configuration& start,
                                                  std::span<const Configuration> path,
                                                  bool with_derivatives, PressedSkin& skin);
  [[nodiscard]] std::vector<PredictedForce> press(const Configuration& start,
                                                  std::span<const Configuration> path,
                                                  bool with_derivatives = true);
  static constexpr double kUnbearable = 10.0;  ///< N
  /// The forces with friction, as the device goes along this way.
  [[nodiscard]] std::vector<double> press_with_friction(const Configuration& start,
                                                        std::span<const Configuration> path);
  /// How far `from` has to be advanced for this force. False where it is not reached within `most`
  /// (m) either way. `reached`: the same with other traits, from where it is found soon, and now
  /// with these.
  [[nodiscard]] bool advance_for(const Configuration& from, double force, double most,
                                 ReachedForce& reached);

  [[nodiscard]] const FingerModel& finger() const { return *finger_; }
  [[nodiscard]] const Device& device() const { return *device_; }
  /// With the traits.
  [[nodiscard]] const std::shared_ptr<const FingerModel>& worn_finger() const { return worn_; }
  [[nodiscard]] const std::shared_ptr<const Device>& worn_device() const { return mounted_; }

 private:
  /// For advance_for(): an advance s (m) at which the twin has settled with this force. `below`:
  /// where the force is less; the search begins at s.
  [[nodiscard]] bool search(const Configuration& from, double force, double below, double most,
                            double& s);
  /// From what was reached with traits hardly different; false where that is none the better.
  [[nodiscard]] bool search_from(const ReachedForce& reached, const Configuration& from,
                                 double force, double most, double& s);
  [[nodiscard]] bool search_from_off_the_skin(const Configuration& from, double force, double most,
                                              double& s);
  [[nodiscard]] bool is_near(const PressedSkin& skin) const;
  /// Skin is where it was at configuration i, stretched as the finger is.
  void begin_from(const PressedSkin& skin, std::size_t i, const Configuration& q);
  void remember(PressedSkin& skin, std::size_t i) const;
  /// False where it takes too long.
  bool settle_at(const Configuration& q);
  [[nodiscard]] PredictedForce felt(bool with_derivatives);
  void make_others();

  std::shared_ptr<const FingerModel> finger_, worn_;
  std::shared_ptr<const Device> device_, mounted_;
  double friction_coefficient_;
  TwinPrecision precision_;
  TraitVector x_;
  Eigen::Matrix<double, 6, kWearerTraits> mount_motion_;
  std::unique_ptr<Twin> twin_;
  struct Other {
    WearerTrait trait;
    std::unique_ptr<Twin> twin;
  };
  // Where derivatives were asked for:
  std::unique_ptr<Twin> same_;
  std::vector<Other> others_;  ///< by each trait of the tissue a little different
};

}  // namespace softfinger
