#pragma once

#include <memory>
#include <vector>

#include "softfinger/device/device.hpp"
#include "softfinger/device/linear_drives.hpp"
#include "softfinger/device/surfaces/pin_surface.hpp"

namespace softfinger {

inline constexpr int kMaxPinRows = 16;  ///< and columns: squared, the most degrees of freedom

/// What moves pins that rise towards the finger one by one: q = their heights, rows first; the
/// stroke is the most. After Wagner, Lederman, Howe, "A tactile shape display using RC
/// servomotors", Haptics Symposium 2002.
class PinDrives final : public LinearDrives {
 public:
  /// The settings come with the axes and joint limits of the kind.
  explicit PinDrives(const DeviceSettings& settings) : LinearDrives(settings, {}, -1) {}

  [[nodiscard]] static std::vector<ConfigurationAxis> axes_for(const PinArrayGeometry& geometry);

  [[nodiscard]] bool advances() const override { return true; }
  /// All pins together.
  void advance(double distance, Configuration& q) const override;

 private:
  [[nodiscard]] std::unique_ptr<Kinematics> copy() const override {
    return std::make_unique<PinDrives>(*this);
  }
  [[nodiscard]] std::vector<AxisReach> reaches() const override;
};

/// The settings come with the axes and joint limits of the kind.
[[nodiscard]] std::shared_ptr<const Device> make_pin_array(DeviceSettings settings,
                                                           const PinArrayGeometry& geometry);

}  // namespace softfinger
