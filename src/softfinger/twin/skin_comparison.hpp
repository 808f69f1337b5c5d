#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/finger/element_loads.hpp"
#include "softfinger/finger/skin_places.hpp"
#include "softfinger/finger/smooth_field.hpp"
#include "softfinger/twin/rendering_measures.hpp"

namespace softfinger {

/// Two fingers side by side, the one that is simulated and the one that wears the device, whatever
/// their meshes and sizes: what either feels is laid on places of the first one's skin and tissue
/// at rest. A place of the wearer's is where it would be if the wearer had the model's size; on the
/// skin, the nearest to that. Allocates only in the constructor.
class SkinComparison {
 public:
  /// How much is compared, each with what stands before it; the measures of the rest are undefined.
  enum class Depth {
    kContact,  ///< forces, and which skin touches
    kSkin,     ///< pressures on it
    kTissue    ///< what the tissue bears
  };

  SkinComparison(std::shared_ptr<const FingerModel> model,
                 std::shared_ptr<const FingerModel> wearer, Depth depth);

  /// The virtual side of a frame: its contact, and where all nodes of the model are, in F, m
  /// (looked at for the tissue alone).
  void take_virtual(const ContactSet& contact, std::span<const Vector3> nodes_F);
  /// The wearer's side, against the virtual one last taken.
  [[nodiscard]] RenderingMeasures compare(const ContactSet& twin, std::span<const Vector3> nodes_F);

  /// Of the virtual contact last taken, at rest, m^2: all of it, and where the wearer has no skin.
  struct Cover {
    double touched = 0.0, bare = 0.0;
  };
  [[nodiscard]] const Cover& cover() const { return cover_; }

 private:
  /// Places of one finger's skin that the common ones are, and what is felt there.
  struct Skin {
    std::vector<SkinPlace> places;
    std::vector<std::size_t> order;  ///< by triangle
    std::optional<SmoothField> field;
    std::vector<std::uint8_t> touched;
    std::vector<double> sample_pressures, pressures;
  };
  struct Tissue {
    ElementLoads loads;
    SmoothField field;
    std::vector<double> densities, component;
    std::vector<Stress> stresses;
    std::vector<double> density_field, stress_field;
  };
  struct Side {
    std::shared_ptr<const FingerModel> model;
    ContactSums sums;
    Skin skin;
    std::optional<Tissue> tissue;
  };

  void build(Side& side, const Vector3& to_common, Depth depth);
  void take(Side& side, const ContactSet& contact, std::span<const Vector3> nodes_F);
  [[nodiscard]] static LaidSide laid(const Side& side);

  std::shared_ptr<const FieldCells> cells_;
  Side virtual_, twin_;
  std::vector<double> areas_;       ///< of the places
  std::vector<std::uint8_t> bare_;  ///< places where the wearer has no skin
  std::vector<double> pressure_weights_, tissue_weights_;
  Cover cover_;
};

/// The places of the wearer's skin that the model's samples are.
[[nodiscard]] std::vector<SkinPlace> counterparts_of_samples(const FingerModel& model,
                                                             const FingerModel& wearer);

/// How much of the model's pad, its skin that faces down at rest, lies where the wearer has skin
/// too, m^2.
struct PadCover {
  double pad = 0.0, covered = 0.0;
};
[[nodiscard]] PadCover pad_cover(const FingerModel& model, const FingerModel& wearer);

}  // namespace softfinger
