#include "softfinger/twin/skin_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_contact.hpp"
#include "softfinger/identification/indentation.hpp"

namespace softfinger {
namespace {

using Fingers = std::shared_ptr<const FingerModel>;

Fingers shipped(const std::string& name) {
  return FingerModel::load(std::filesystem::path(source_folder()) / "fingers" / (name + ".toml"));
}

/// Another one with this size, each length times `scale`.
std::shared_ptr<FingerModel> scaled(const FingerModel& model, double scale) {
  auto larger = std::make_shared<FingerModel>(model);
  for (Vector3& node : larger->mesh.nodes) node *= scale;
  for (double& area : larger->sample_rest_areas) area *= scale * scale;
  return larger;
}

/// A finger pressed to one depth: its contact, and where its nodes are, in F.
struct Press {
  ContactSet contact;
  std::vector<Vector3> nodes_F;
};

/// The rows of a press to `depth`.
std::vector<Press> presses(const FingerModel& model, const Indenter& indenter, double depth,
                           int rows) {
  IndentationOptions options;
  options.depth = depth;
  options.rows = rows;
  std::vector<Press> presses;
  indent(model, indenter, options, [&](const IndentationState& state) {
    EXPECT_GT(state.contact.normal_force, 0.005);
    presses.push_back({state.contact, std::vector<Vector3>(state.positions.size())});
    transform(state.X_WF.inverse(), state.positions, presses.back().nodes_F);
  });
  return presses;
}

Press pressed(const FingerModel& model, const Indenter& indenter, double depth) {
  return presses(model, indenter, depth, 3).back();
}

RenderingMeasures judged(const Fingers& model, const Press& virtual_side, const Fingers& wearer,
                         const Press& twin) {
  SkinComparison comparison(model, wearer, SkinComparison::Depth::kTissue);
  comparison.take_virtual(virtual_side.contact, virtual_side.nodes_F);
  return comparison.compare(twin.contact, twin.nodes_F);
}

TEST(SkinComparison, OfAFingerWithItselfFindsNothing) {
  const Fingers model = shipped("index");
  const Press press = pressed(*model, Indenter::ball(10 * mm, 1 * mm, 0.0), 1 * mm);
  const RenderingMeasures m = judged(model, press, model, press);
  EXPECT_EQ(m.kind, FrameKind::kBoth);
  for (const MeasureName& name : measure_names()) {
    EXPECT_EQ(m.*name.member, name.name == "iou" ? 1.0 : 0.0) << name.name;
  }
}

// What is not looked at is undefined, and the rest the same to the bit.
TEST(SkinComparison, OfLessDepthLeavesOutWhatLiesDeeper) {
  using Depth = SkinComparison::Depth;
  const Fingers model = shipped("index");
  const Press a = pressed(*model, Indenter::ball(10 * mm, 1 * mm, 0.0), 1 * mm);
  const Press b = pressed(*model, Indenter::plane(), 1.2 * mm);
  const RenderingMeasures all = judged(model, a, model, b);
  for (const Depth depth : {Depth::kContact, Depth::kSkin}) {
    SkinComparison comparison(model, model, depth);
    comparison.take_virtual(a.contact, {});
    const RenderingMeasures some = comparison.compare(b.contact, {});
    for (const MeasureName& name : measure_names()) {
      const bool of_tissue =
          name.name == "stress_error" || name.name == "strain_energy_density_error";
      const bool of_pressure = name.name == "pressure_error";
      ASSERT_GT(all.*name.member * all.*name.member, 0.0) << name.name;
      if (of_tissue || (of_pressure && depth == Depth::kContact)) {
        EXPECT_TRUE(std::isnan(some.*name.member)) << name.name;
      } else {
        EXPECT_EQ(some.*name.member, all.*name.member) << name.name;
      }
    }
  }
}

// What two fingers of one shape and tissue feel of one obstacle at one depth is the same contact.
// Their stresses are those of elements of 1 to 3 mm, and differ by more than their places.
TEST(SkinComparison, TheSameContactIsTheSameOnAnyMesh) {
  struct Mesh {
    const char* name;
    Fingers finger;
    std::vector<Press> presses;
  };
  std::vector<Mesh> meshes{{"S", shipped("index"), {}},
                           {"M", shipped("index-medium"), {}},
                           {"L", shipped("index-fine"), {}}};
  for (const auto& [obstacle, indenter] :
       {std::pair{"plane", Indenter::plane()}, std::pair{"ball", Indenter::ball(20 * mm, 0, 0)}}) {
    for (Mesh& mesh : meshes) mesh.presses = presses(*mesh.finger, indenter, 1.5 * mm, 5);
    for (const Mesh& a : meshes) {
      for (const Mesh& b : meshes) {
        if (&a == &b) continue;
        SkinComparison comparison(a.finger, b.finger, SkinComparison::Depth::kTissue);
        for (std::size_t row = 0; row < a.presses.size(); ++row) {
          comparison.take_virtual(a.presses[row].contact, a.presses[row].nodes_F);
          const RenderingMeasures m =
              comparison.compare(b.presses[row].contact, b.presses[row].nodes_F);
          std::cout << obstacle << " " << 0.3 * static_cast<double>(row + 1) << " mm, " << a.name
                    << " and " << b.name << ": iou " << m.iou << ", area " << m.contact_area_error
                    << ", force " << m.normal_force_bias << ", pressure " << m.pressure_error
                    << ", energy " << m.strain_energy_density_error << ", stress " << m.stress_error
                    << "\n";
          // Deepest, the border lies where S has sides of 3 mm, and is a quarter of one off.
          EXPECT_GE(m.iou, row < 4 ? 0.9 : 0.87);
          EXPECT_LT(m.centroid_shift, 0.25 * mm);
          EXPECT_LT(m.pressure_error, 0.3);
          EXPECT_LT(m.strain_energy_density_error, 0.35);
          EXPECT_LT(m.stress_error, 0.4);
        }
      }
    }
  }
}

// A finger 10 % larger and pressed 10 % deeper has the same stretches, and so the same stresses, at
// the same places.
TEST(SkinComparison, KnowsAPlaceOnAFingerOfAnotherSize) {
  const std::shared_ptr<FingerModel> model = scaled(*shipped("index"), 1.0);
  model->feature_contact = false;  // lies so deep, whatever the size
  const std::shared_ptr<FingerModel> larger = scaled(*model, 1.1);
  larger->contact_tolerance *= 1.1;
  const Press press = pressed(*model, Indenter::ball(8 * mm, 1 * mm, 2 * mm), 1 * mm);
  const Press of_larger = pressed(*larger, Indenter::ball(8.8 * mm, 1.1 * mm, 2.2 * mm), 1.1 * mm);
  for (const bool forth : {true, false}) {
    const RenderingMeasures m =
        forth ? judged(model, press, larger, of_larger) : judged(larger, of_larger, model, press);
    EXPECT_GT(m.iou, 0.97) << forth;
    EXPECT_NEAR(m.normal_force_bias, forth ? 0.21 : 1.0 / 1.21 - 1.0, 0.02);
    EXPECT_LT(m.pressure_error, 0.05);
    EXPECT_LT(m.strain_energy_density_error, 0.05);
    EXPECT_LT(m.stress_error, 0.05);
  }
}

Fingers mirrored(const FingerModel& model) {
  auto other = std::make_shared<FingerModel>(model);
  for (Vector3& node : other->mesh.nodes) node.y() = -node.y();
  for (auto& tetrahedron : other->mesh.tetrahedra) std::swap(tetrahedron[2], tetrahedron[3]);
  for (auto& triangle : other->mesh.triangles) std::swap(triangle[1], triangle[2]);
  for (auto& triangle : other->skin_triangles) std::swap(triangle[1], triangle[2]);
  return other;
}

TEST(SkinComparison, SeesTheSameInAMirror) {
  const Fingers model = shipped("index"), wearer = shipped("index-medium");
  const Fingers model_seen = mirrored(*model), wearer_seen = mirrored(*wearer);
  const auto measured = [](const Fingers& of, const Fingers& on, double side) {
    const Press press = pressed(*of, Indenter::ball(9 * mm, 1 * mm, side * 2 * mm), 1 * mm);
    const Press twin = pressed(*on, Indenter::ball(9 * mm, 2 * mm, side * 1 * mm), 0.8 * mm);
    return judged(of, press, on, twin);
  };
  const RenderingMeasures m = measured(model, wearer, 1.0);
  const RenderingMeasures seen = measured(model_seen, wearer_seen, -1.0);
  EXPECT_LT(m.iou, 0.9);  // they differ
  EXPECT_NEAR(seen.iou, m.iou, 1e-3);
  EXPECT_NEAR(seen.normal_force_bias, m.normal_force_bias, 1e-4);
  EXPECT_NEAR(seen.centroid_shift, m.centroid_shift, 1e-3 * mm);
  // The cells do not lie the same way on either side.
  EXPECT_NEAR(seen.pressure_error, m.pressure_error, 0.01);
  EXPECT_NEAR(seen.strain_energy_density_error, m.strain_energy_density_error, 0.01);
  EXPECT_NEAR(seen.stress_error, m.stress_error, 0.01);
}

TEST(SkinComparison, KnowsWhereTheWearerHasNoSkin) {
  const Fingers model = shipped("index");
  auto bare = std::make_shared<FingerModel>(*shipped("index-medium"));
  std::erase_if(bare->skin_triangles, [&](const std::array<int, 3>& triangle) {
    double x = 0.0;
    for (const int sample : triangle) {
      const int node = bare->sample_nodes[static_cast<std::size_t>(sample)];
      x += bare->mesh.nodes[static_cast<std::size_t>(node)].x() / 3.0;
    }
    return x > 4 * mm;
  });
  SkinComparison comparison(model, bare, SkinComparison::Depth::kSkin);
  const Press at_end = pressed(*model, Indenter::ball(6 * mm, 9 * mm, 0.0), 1 * mm);
  comparison.take_virtual(at_end.contact, {});
  EXPECT_GT(comparison.cover().touched, 8 * mm2);
  EXPECT_GT(comparison.cover().bare, 0.6 * comparison.cover().touched);
  const Press proximal = pressed(*model, Indenter::ball(6 * mm, 0.0, 0.0), 0.5 * mm);
  comparison.take_virtual(proximal.contact, {});
  EXPECT_GT(comparison.cover().touched, 5 * mm2);
  EXPECT_EQ(comparison.cover().bare, 0.0);
  const PadCover part = pad_cover(*model, *bare);
  EXPECT_LT(part.covered, 0.8 * part.pad);
  const PadCover whole = pad_cover(*model, *shipped("index-medium"));
  EXPECT_GT(whole.pad, 50 * mm2);
  EXPECT_EQ(whole.covered, whole.pad);
}

}  // namespace
}  // namespace softfinger
