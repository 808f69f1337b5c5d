#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "softfinger/contact/contact_sums.hpp"

namespace softfinger {

/// Which of the two sides touches in a frame.
enum class FrameKind {
  kBoth,
  kFree,    ///< neither
  kMissed,  ///< the virtual finger only: the device does not render the contact
  kFalse    ///< the twin only: the device touches where nothing is
};

/// How far what the device renders is from the virtual contact, in one frame. NaN where undefined:
/// all but the IoU where one side touches nothing, which is then 0, and all where neither does;
/// what needs areas where none is in contact.
struct RenderingMeasures {
  static constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
  FrameKind kind = FrameKind::kFree;
  double iou = kUndefined;                 ///< of the skin in contact, by rest area, 0 to 1
  double centroid_shift = kUndefined;      ///< of the force-weighted centroids, m
  double normal_angle = kUndefined;        ///< between mean normals, rad
  double normal_force_error = kUndefined;  ///< |f_twin - f_virtual| / max(f_virtual, 0.05 N)
  double normal_force_bias = kUndefined;   ///< the same with its sign
  /// |t_twin - t_virtual| / max(f_virtual, 0.05 N), t the tangential forces summed as vectors in F.
  double tangential_force_error = kUndefined;
  double slip_ratio_error = kUndefined;    ///< |s_twin - s_virtual|, see ContactSums::slip_ratio
  double contact_area_error = kUndefined;  ///< |a_twin - a_virtual| / a_virtual, deformed areas
  double pressure_error = kUndefined;      ///< sqrt(sum a (p_t - p_v)^2 / sum a p_v^2)
  double strain_energy_density_error = kUndefined;  ///< likewise in the tissue by rest volume
  double stress_error = kUndefined;                 ///< likewise, all components of the stress
};

/// Whether a side of a frame touches: it has a contact set, or bears more than 0.01 N. Friction
/// alone may bear: skin that is drawn off still holds on.
[[nodiscard]] bool touches(const ContactSums& side);

/// One side of a frame, laid on places that both sides have in common.
struct LaidSide {
  const ContactSums& sums;
  std::span<const std::uint8_t> touched;     ///< by place on the skin: in contact
  std::span<const double> pressures;         ///< by cell along the skin, Pa
  std::span<const double> energy_densities;  ///< by cell of the tissue, J/m^3
  std::span<const double> stresses;          ///< likewise, Pa, component by component of Stress
};

/// How much each of these places counts; the tissue's may be none.
struct PlaceWeights {
  std::span<const double> skin;       ///< m^2
  std::span<const double> pressures;  ///< m^2
  std::span<const double> tissue;     ///< m^3
};

[[nodiscard]] RenderingMeasures compare(const LaidSide& virtual_side, const LaidSide& twin,
                                        const PlaceWeights& weights);

/// Every measure by its name in files, with what one unit there is in SI.
struct MeasureName {
  std::string_view name;  ///< "centroid_shift_mm"
  double unit;
  double RenderingMeasures::*member;
};
inline constexpr std::size_t kMeasures = 11;
[[nodiscard]] const std::array<MeasureName, kMeasures>& measure_names();

/// Means over frames, each over the frames in which it is defined.
class MeasureMeans {
 public:
  void add(const RenderingMeasures& measures);
  [[nodiscard]] RenderingMeasures mean() const;  ///< kind is meaningless
  [[nodiscard]] int frames(FrameKind kind) const { return frames_[static_cast<std::size_t>(kind)]; }

 private:
  std::array<double, kMeasures> sums_{};
  std::array<int, kMeasures> counts_{};
  std::array<int, 4> frames_{};
};

}  // namespace softfinger
