#include "softfinger/matching/skin_points.hpp"

#include <algorithm>
#include <span>

namespace softfinger {
namespace {

bool is_soft_contact(const ContactSample& sample) { return sample.in_contact && sample.on_soft; }

}  // namespace

SkinPoints::SkinPoints(int capacity) {
  const std::size_t size = static_cast<std::size_t>(capacity) + ContactSet::kMostFeatures;
  points_F_.resize(size);
  in_contact_.resize(size);
  areas_.resize(size);
  gaps_.resize(size);
  shares_.resize(size);
  nothing_touches_.assign(size, 0);
}

ContactPoints SkinPoints::take(const ContactSet& contact, bool touching) {
  const std::size_t room = points_F_.size() - ContactSet::kMostFeatures;
  std::size_t count = 0;
  double greatest = 0.0;  // Pa, on soft objects
  const auto put = [&](const Vector3& position_F, bool touches, double area, double gap) {
    points_F_[count] = position_F;
    in_contact_[count] = touches ? 1 : 0;
    areas_[count] = area;
    gaps_[count] = gap;
    ++count;
  };
  for (const ContactSample& sample :
       std::span(contact.samples).first(std::min(contact.samples.size(), room))) {
    if (is_soft_contact(sample)) greatest = std::max(greatest, sample.pressure());
    put(sample.position_F, sample.in_contact, sample.weight(), sample.gap);
  }
  for (const ContactFeature& feature : contact.features()) {
    put(feature.position_F, true, feature.rest_area, feature.gap);
  }
  std::fill_n(shares_.begin(), count, 1.0);
  for (std::size_t i = 0; greatest > 0.0 && i < std::min(contact.samples.size(), room); ++i) {
    const ContactSample& sample = contact.samples[i];
    if (is_soft_contact(sample)) shares_[i] = sample.pressure() / greatest;
  }
  return {{points_F_.data(), count},
          {touching ? in_contact_.data() : nothing_touches_.data(), count},
          {areas_.data(), count},
          {gaps_.data(), count},
          {shares_.data(), count}};
}

}  // namespace softfinger
