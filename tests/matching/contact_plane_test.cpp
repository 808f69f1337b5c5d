#include "softfinger/matching/contact_plane.hpp"

#include <gtest/gtest.h>

#include "../support/folders.hpp"
#include "pad.hpp"

namespace softfinger {
namespace {

std::shared_ptr<const Device> device_of_file(const std::string& name) {
  return load_device(source_folder() + "/devices/" + name + ".toml");
}

Vector3 leaning(double tilt_deg, double azimuth_deg) {
  return {std::sin(tilt_deg * deg) * std::cos(azimuth_deg * deg),
          std::sin(tilt_deg * deg) * std::sin(azimuth_deg * deg), std::cos(tilt_deg * deg)};
}

TEST(ContactPlane, OfPointsIsTheirPlaneTowardsTheFinger) {
  std::mt19937 random(1);
  const Vector3 normal = leaning(9.0, 70.0);
  const Pad pad = press_plane(resting_pad(120, random), Vector3(0.0, 0.0, -5.5 * mm), normal);
  ASSERT_GT(pad.contacts(), 5);
  for (const MatchingWeights weights : {MatchingWeights::kUniform, MatchingWeights::kArea}) {
    const FittedPlane plane = contact_plane(pad.view(), weights, *thimble());
    EXPECT_LT((plane.normal - normal).norm(), 1e-9);
    EXPECT_NEAR(normal.dot(plane.point - Vector3(0.0, 0.0, -5.5 * mm)), 0.0, 1e-12);
  }
}

TEST(ContactPlane, LeavesOpenWhatPointsOnALineDo) {
  Pad pad;
  for (const double x : {-1.0, 0.5, 2.0}) pad.points.emplace_back(Vector3(x, 0.0, -7.0) * mm);
  pad.in_contact = {1, 1, 1};
  const FittedPlane plane = contact_plane(pad.view(), MatchingWeights::kUniform, *thimble());
  EXPECT_EQ(plane.normal, Vector3::Zero());
  EXPECT_LT((plane.point - Vector3(0.5, 0.0, -7.0) * mm).norm(), 1e-12);
  const Configuration q = on_plane(*thimble(), plane);
  EXPECT_EQ(q.head(2), thimble()->home().head(2));
  EXPECT_LT(thimble()->closest_point_residual(q, plane.point).residual.norm(), 1e-9);
}

// A disk lies in the plane; what has no face to turn touches it at the point, by the least way.
TEST(OnPlane, EveryDeviceMeetsThePoint) {
  const FittedPlane plane{Vector3(1.0, -0.5, -6.5) * mm, leaning(8.0, 200.0)};
  for (const char* name :
       {"thimble-3rrs", "thimble-3rrs-mechanism", "cable-prattichizzo", "plate-6dof", "disk-linear",
        "delta-schorr", "five-bar", "membrane", "roller-provancher", "shear-tactor-gleeson",
        "slip-ball-webster", "slip-wheel-salada", "strap-minamizawa"}) {
    const auto device = device_of_file(name);
    ASSERT_TRUE(takes_plane(*device)) << name;
    const Configuration q = on_plane(*device, plane);
    EXPECT_LT(device->closest_point_residual(q, plane.point).residual.norm(), 1e-8) << name;
    EXPECT_GT(std::sqrt(device->squared_distance(q, device->home())), 0.1 * mm) << name;
  }
  for (const char* name : {"thimble-3rrs", "cable-prattichizzo", "plate-6dof"}) {
    const auto device = device_of_file(name);
    const Pose X_FP = device->surface_pose(on_plane(*device, plane));
    EXPECT_LT((X_FP.rotation.col(2) - plane.normal).norm(), 1e-9) << name;
  }
}

TEST(OnPlane, PinsAreAsHighAsThePlaneOverThem) {
  const auto device = device_of_file("pins-wagner-6x6");
  const Pose X_FB = device->surface_pose(device->home());
  const FittedPlane plane{X_FB * (Vector3(0.5, -1.0, 0.9) * mm),
                          X_FB.rotation * leaning(7.0, 30.0)};
  const Configuration q = on_plane(*device, plane);
  std::vector<SolidPiece> pins(static_cast<std::size_t>(device->solid_piece_count()));
  device->solid_pieces(q, pins);
  int between = 0;
  for (int k = 0; k < q.size(); ++k) {
    const ConfigurationAxis& axis = device->axes()[static_cast<std::size_t>(k)];
    if (q[k] <= axis.min || q[k] >= axis.max) continue;
    ++between;
    Vector3 end = X_FB.inverse() * pins[static_cast<std::size_t>(k)].X_FS.translation;
    end.z() = q[k];
    EXPECT_NEAR(plane.normal.dot(X_FB * end - plane.point), 0.0, 1e-12) << k;
  }
  EXPECT_GT(between, 20);
}

}  // namespace
}  // namespace softfinger
