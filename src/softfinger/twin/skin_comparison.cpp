#include "softfinger/twin/skin_comparison.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "softfinger/contact/contact_area.hpp"
#include "softfinger/finger/finger_size.hpp"

namespace softfinger {
namespace {

/// Between places on the skin, m.
constexpr double kSpacing = 0.5e-3;
/// Between the points that tell in which cells a part of the tissue is, m.
constexpr double kTissueSpacing = 0.7e-3;
/// Where the wearer has no skin as near as this, it has none, m.
constexpr double kNear = 2e-3;
/// Skin faces down where its normal has more than this of -z: it is no more than 60 degrees off.
constexpr double kDown = 0.5;

const Vector3& node_of(const FingerModel& model, int node) {
  return model.mesh.nodes[static_cast<std::size_t>(node)];
}

Eigen::AlignedBox3d box_of(const FingerModel& model) {
  Eigen::AlignedBox3d box;
  for (const Vector3& node : model.mesh.nodes) box.extend(node);
  return box;
}

/// Places of the wearer's skin that are the model's, and which of them are not there.
struct Counterparts {
  std::vector<SkinPlace> places;
  std::vector<std::uint8_t> bare;
};

Counterparts counterparts(const FingerModel& model, const std::vector<SkinPlace>& places,
                          const FingerModel& wearer) {
  if (&model == &wearer) return {places, std::vector<std::uint8_t>(places.size(), 0)};
  const Vector3 to_wearer = size_ratio(model, wearer);
  const RestingSkin skin(wearer);
  Counterparts result;
  for (const SkinPlace& place : places) {
    const Vector3 wanted = rest_position(model, place).cwiseProduct(to_wearer);
    result.places.push_back(skin.nearest(wanted));
    const Vector3 found = rest_position(wearer, result.places.back());
    result.bare.push_back((found - wanted).norm() > kNear ? 1 : 0);
  }
  return result;
}

std::vector<std::size_t> by_triangle(const std::vector<SkinPlace>& places) {
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return places[k].triangle; });
  return order;
}

/// Each sample's area, spread over the places around it by the weight that it has there.
void add_samples(const FingerModel& model, const Vector3& to_common, SmoothField& field) {
  const auto [places, areas] = even_places(model, kSpacing);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto& corners = model.skin_triangles[static_cast<std::size_t>(places[k].triangle)];
    const Vector3 p = rest_position(model, places[k]).cwiseProduct(to_common);
    for (std::size_t c = 0; c < 3; ++c) {
      field.add(static_cast<std::size_t>(corners[c]), p, places[k].weights[c] * areas[k]);
    }
  }
}

/// Each soft element's volume, at points a spacing apart.
void add_elements(const FingerModel& model, const ElementLoads& loads, const Vector3& to_common,
                  SmoothField& field) {
  for (std::size_t e = 0; e < loads.size(); ++e) {
    std::array<Vector3, 4> corners;
    double longest = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      corners[k] = node_of(model, loads.nodes(e)[k]).cwiseProduct(to_common);
      for (std::size_t j = 0; j < k; ++j) {
        longest = std::max(longest, (corners[k] - corners[j]).norm());
      }
    }
    const int parts = std::max(1, static_cast<int>(std::ceil(longest / kTissueSpacing)));
    const int points = parts * (parts + 1) * (parts + 2) / 6;
    const double volume = loads.volumes()[e] / points;
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        for (int k = 0; i + j + k < parts; ++k) {
          const auto weight = [&](int n) { return (n + 0.25) / parts; };
          field.add(e,
                    weight(i) * corners[0] + weight(j) * corners[1] + weight(k) * corners[2] +
                        weight(parts - 1 - i - j - k) * corners[3],
                    volume);
        }
      }
    }
  }
}

/// The first one's amounts, in cells where the second has some too.
std::vector<double> common_amounts(const SmoothField& of, const SmoothField& other) {
  std::vector<double> weights(of.amounts().begin(), of.amounts().end());
  for (std::size_t c = 0; c < weights.size(); ++c) {
    if (!(other.amounts()[c] > 0.0)) weights[c] = 0.0;
  }
  return weights;
}

}  // namespace

SkinComparison::SkinComparison(std::shared_ptr<const FingerModel> model,
                               std::shared_ptr<const FingerModel> wearer, Depth depth)
    : cells_(std::make_shared<FieldCells>(box_of(*model))) {
  virtual_.model = std::move(model);
  twin_.model = std::move(wearer);
  auto [places, areas] = even_places(*virtual_.model, kSpacing);
  Counterparts found = counterparts(*virtual_.model, places, *twin_.model);
  virtual_.skin.places = std::move(places);
  areas_ = std::move(areas);
  twin_.skin.places = std::move(found.places);
  bare_ = std::move(found.bare);
  build(virtual_, Vector3::Ones(), depth);
  build(twin_, size_ratio(*twin_.model, *virtual_.model), depth);
  if (depth == Depth::kContact) return;
  pressure_weights_ = common_amounts(*virtual_.skin.field, *twin_.skin.field);
  if (depth == Depth::kTissue) {
    tissue_weights_ = common_amounts(virtual_.tissue->field, twin_.tissue->field);
  }
}

void SkinComparison::build(Side& side, const Vector3& to_common, Depth depth) {
  const FingerModel& model = *side.model;
  Skin& skin = side.skin;
  skin.order = by_triangle(skin.places);
  skin.touched.resize(skin.places.size());
  if (depth == Depth::kContact) return;
  skin.sample_pressures.resize(model.sample_nodes.size());
  skin.pressures.resize(cells_->size());
  skin.field.emplace(cells_);
  add_samples(model, to_common, *skin.field);
  skin.field->finish();
  if (depth == Depth::kSkin) return;
  side.tissue.emplace(Tissue{ElementLoads(side.model), SmoothField(cells_), {}, {}, {}, {}, {}});
  Tissue& tissue = *side.tissue;
  add_elements(model, tissue.loads, to_common, tissue.field);
  tissue.field.finish();
  tissue.densities.resize(tissue.loads.size());
  tissue.component.resize(tissue.loads.size());
  tissue.stresses.resize(tissue.loads.size());
  tissue.density_field.resize(cells_->size());
  tissue.stress_field.resize(6 * cells_->size());
}

void SkinComparison::take(Side& side, const ContactSet& contact, std::span<const Vector3> nodes_F) {
  side.sums = contact.sums();
  if (!touches(contact)) return;
  Skin& skin = side.skin;
  for (auto k = skin.order.begin(); k != skin.order.end();) {
    const int triangle = skin.places[*k].triangle;
    const auto t = static_cast<std::size_t>(triangle);
    const TriangleInContact touched(contact, t, side.model->skin_triangles[t]);
    for (; k != skin.order.end() && skin.places[*k].triangle == triangle; ++k) {
      skin.touched[*k] = touched.has(skin.places[*k].weights) ? 1 : 0;
    }
  }
  if (!skin.field) return;
  for (std::size_t i = 0; i < contact.samples.size(); ++i) {
    const ContactSample& sample = contact.samples[i];
    skin.sample_pressures[i] = sample.normal_force / side.model->sample_rest_areas[i];
  }
  skin.field->spread(skin.sample_pressures, skin.pressures);
  if (!side.tissue) return;
  Tissue& tissue = *side.tissue;
  tissue.loads.energy_densities(nodes_F, tissue.densities);
  tissue.field.spread(tissue.densities, tissue.density_field);
  tissue.loads.stresses(nodes_F, tissue.stresses);
  for (std::size_t c = 0; c < 6; ++c) {
    std::ranges::transform(tissue.stresses, tissue.component.begin(),
                           [c](const Stress& stress) { return stress[c]; });
    tissue.field.spread(tissue.component,
                        std::span(tissue.stress_field).subspan(c * cells_->size(), cells_->size()));
  }
}

void SkinComparison::take_virtual(const ContactSet& contact, std::span<const Vector3> nodes_F) {
  take(virtual_, contact, nodes_F);
  cover_ = {};
  if (!touches(contact)) return;
  for (std::size_t k = 0; k < areas_.size(); ++k) {
    if (virtual_.skin.touched[k] == 0) continue;
    cover_.touched += areas_[k];
    if (bare_[k] != 0) cover_.bare += areas_[k];
  }
}

RenderingMeasures SkinComparison::compare(const ContactSet& twin,
                                          std::span<const Vector3> nodes_F) {
  take(twin_, twin, nodes_F);
  for (std::size_t k = 0; k < bare_.size(); ++k) {
    if (bare_[k] != 0) twin_.skin.touched[k] = 0;
  }
  return softfinger::compare(laid(virtual_), laid(twin_),
                             {areas_, pressure_weights_, tissue_weights_});
}

LaidSide SkinComparison::laid(const Side& side) {
  LaidSide laid{side.sums, side.skin.touched, side.skin.pressures, {}, {}};
  if (side.tissue) {
    laid.energy_densities = side.tissue->density_field;
    laid.stresses = side.tissue->stress_field;
  }
  return laid;
}

std::vector<SkinPlace> counterparts_of_samples(const FingerModel& model,
                                               const FingerModel& wearer) {
  std::vector<SkinPlace> corners(model.sample_nodes.size());
  for (std::size_t t = 0; t < model.skin_triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      SkinPlace& corner = corners[static_cast<std::size_t>(model.skin_triangles[t][c])];
      corner.triangle = static_cast<int>(t);
      corner.weights = {};
      corner.weights[c] = 1.0;
    }
  }
  return counterparts(model, corners, wearer).places;
}

PadCover pad_cover(const FingerModel& model, const FingerModel& wearer) {
  const auto [places, areas] = even_places(model, kSpacing);
  const Counterparts found = counterparts(model, places, wearer);
  PadCover cover;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto& corners = model.skin_triangles[static_cast<std::size_t>(places[k].triangle)];
    const auto at = [&](std::size_t c) {
      return node_of(model, model.sample_nodes[static_cast<std::size_t>(corners[c])]);
    };
    if ((at(1) - at(0)).cross(at(2) - at(0)).normalized().z() > -kDown) continue;
    cover.pad += areas[k];
    if (found.bare[k] == 0) cover.covered += areas[k];
  }
  return cover;
}

}  // namespace softfinger
