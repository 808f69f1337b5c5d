// In which order a mesh lists its nodes and elements, and a scene its objects, is nobody's physics.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "drawn_exploration.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger::relations {
namespace {

/// 0 .. count - 1 in a drawn order.
std::vector<int> shuffled(Draw& draw, std::size_t count) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = count; i > 1; --i) {
    std::swap(order[i - 1], order[static_cast<std::size_t>(draw.below(static_cast<int>(i)))]);
  }
  return order;
}

template <typename T>
std::vector<T> in_order(const std::vector<T>& values, const std::vector<int>& order) {
  std::vector<T> result;
  result.reserve(order.size());
  for (const int from : order) result.push_back(values[static_cast<std::size_t>(from)]);
  return result;
}

std::vector<int> inverse(const std::vector<int>& order) {
  std::vector<int> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  }
  return place;
}

template <std::size_t N>
void rename(std::vector<std::array<int, N>>& corners, const std::vector<int>& place) {
  for (auto& each : corners) {
    for (int& corner : each) corner = place[static_cast<std::size_t>(corner)];
  }
}

std::shared_ptr<FingerModel> with_other_nodes(const FingerModel& model, Draw& draw) {
  auto other = std::make_shared<FingerModel>(model);
  const std::vector<int> nodes = shuffled(draw, model.mesh.nodes.size());
  const std::vector<int> place = inverse(nodes);
  other->mesh.nodes = in_order(model.mesh.nodes, nodes);
  other->node_is_rigid = in_order(model.node_is_rigid, nodes);
  rename(other->mesh.tetrahedra, place);
  rename(other->mesh.triangles, place);
  const std::vector<int> samples = shuffled(draw, model.sample_nodes.size());
  other->sample_nodes = in_order(model.sample_nodes, samples);
  for (int& node : other->sample_nodes) node = place[static_cast<std::size_t>(node)];
  other->sample_rest_areas = in_order(model.sample_rest_areas, samples);
  rename(other->skin_triangles, inverse(samples));
  return other;
}

std::shared_ptr<FingerModel> with_other_elements(const FingerModel& model, Draw& draw) {
  auto other = std::make_shared<FingerModel>(model);
  const std::vector<int> order = shuffled(draw, model.mesh.tetrahedra.size());
  other->mesh.tetrahedra = in_order(model.mesh.tetrahedra, order);
  other->mesh.tetrahedron_volume = in_order(model.mesh.tetrahedron_volume, order);
  other->tetrahedron_material = in_order(model.tetrahedron_material, order);
  const std::vector<int> surfaces = shuffled(draw, model.mesh.triangles.size());
  other->mesh.triangles = in_order(model.mesh.triangles, surfaces);
  other->mesh.triangle_surface = in_order(model.mesh.triangle_surface, surfaces);
  other->skin_triangles =
      in_order(model.skin_triangles, shuffled(draw, model.skin_triangles.size()));
  return other;
}

void expect_alike(const Exploration& exploration, std::shared_ptr<FingerModel> other,
                  double tolerance) {
  const Trace a = explore(exploration);
  Exploration shuffled = exploration;
  shuffled.model = std::move(other);
  const Trace b = explore(shuffled);
  ASSERT_GT(a.most_force, 0.01) << exploration.what;
  expect_agreement(departure(a, b), exploration, tolerance);
}

/// Of the samples alone, without points inside triangles, and of elements each by itself.
std::shared_ptr<const FingerModel> plain(const FingerModel& model) {
  auto bare = std::make_shared<FingerModel>(model);
  bare->feature_contact = false;
  bare->dilatation = Dilatation::kElement;
  return bare;
}

// Sums are taken in another order: rounding, and where the iterations of a step end, 1e-6 of its
// residual. Points inside triangles take places in the order in which they are found, and two
// that are alike may take turns.
constexpr double kSamplesInOrder = 1e-4;
constexpr double kFeaturesInOrder = 0.05;

TEST(Order, OfNodesAndSamples) {
  for (int number = 0; number < cases(5); ++number) {
    Draw draw("nodes", number);
    Exploration exploration = draw_exploration(draw, number, kSmoothThings);
    expect_alike(exploration, with_other_nodes(*exploration.model, draw), kFeaturesInOrder);
    exploration.model = plain(*exploration.model);
    expect_alike(exploration, with_other_nodes(*exploration.model, draw), kSamplesInOrder);
  }
}

TEST(Order, OfElementsAndTriangles) {
  for (int number = 0; number < cases(5); ++number) {
    Draw draw("elements", number);
    Exploration exploration = draw_exploration(draw, number, kSmoothThings);
    exploration.model = plain(*exploration.model);
    expect_alike(exploration, with_other_elements(*exploration.model, draw), kSamplesInOrder);
  }
}

// Patches go by where elements are.
TEST(Order, OfElementsInPatches) {
  for (int number = 0; number < cases(5); ++number) {
    Draw draw("patches", number);
    Exploration exploration = draw_exploration(draw, number, kSmoothThings);
    auto model = std::make_shared<FingerModel>(*plain(*exploration.model));
    model->dilatation = Dilatation::kPatch;
    exploration.model = model;
    expect_alike(exploration, with_other_elements(*model, draw), kSamplesInOrder);
  }
}

TEST(Order, OfElementsAndTrianglesWithFeatures) {
  for (int number = 0; number < cases(5); ++number) {
    Draw draw("elements", number);
    Exploration exploration = draw_exploration(draw, number, kAllThings);
    auto model = std::make_shared<FingerModel>(*exploration.model);
    model->dilatation = Dilatation::kElement;
    exploration.model = model;
    expect_alike(exploration, with_other_elements(*model, draw), kFeaturesInOrder);
  }
}

// Two objects at once, and others out of reach.
TEST(Order, OfObjects) {
  for (int number = 0; number < cases(4); ++number) {
    Draw draw("objects", number);
    Exploration exploration = draw_exploration(draw, number, kSmoothThings);
    std::string what;
    VirtualObject second = exploration.objects.front();
    second.shape = Ball{4 * mm};
    second.motion = Trajectory(Pose{Matrix3::Identity(), Vector3(2.0, 6.0, -3.4) * mm});
    VirtualObject away = second;
    away.motion = Trajectory(Pose{Matrix3::Identity(), Vector3(0.0, 0.2, 0.0)});
    exploration.objects.push_back(second);
    exploration.objects.push_back(away);
    Exploration other = exploration;
    std::reverse(other.objects.begin(), other.objects.end());
    const Trace a = explore(exploration);
    ASSERT_GT(a.most_force, 0.01) << exploration.what;
    expect_agreement(departure(a, explore(other)), exploration, kFeaturesInOrder);
    exploration.model = other.model = plain(*exploration.model);
    expect_agreement(departure(explore(exploration), explore(other)), exploration, kSamplesInOrder);
  }
}

}  // namespace
}  // namespace softfinger::relations
