// Force limit of position-driven devices: whatever is wanted, a finger half as stiff again as the
// model is pressed with no more.

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>

#include "project.hpp"
#include "softfinger/actuation/force_ceiling.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_size.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

std::shared_ptr<const FingerModel> index_finger() {
  return FingerModel::load(kProject / "fingers" / "index.toml");
}

std::shared_ptr<const FingerModel> stiffer(const FingerModel& model, double factor) {
  auto wearer = std::make_shared<FingerModel>(model);
  for (auto& material : wearer->materials) material.youngs_modulus *= factor;
  wearer->strain_limits.stiffness *= factor;
  return wearer;
}

struct LimitedDevice {
  const char* file;
  double force;  ///< N
  /// Part of it that some pose comes to, at least. A tip that is moved aside has a table made for
  /// 0.75 of it, and 0.73 is what the best of these poses comes to.
  double reached;
};
void PrintTo(const LimitedDevice& device, std::ostream* out) { *out << device.file; }

class ForceCeilingOf : public ::testing::TestWithParam<LimitedDevice> {
 protected:
  std::shared_ptr<const FingerModel> model = index_finger();
  std::shared_ptr<const Device> device =
      load_device(kProject / "devices" / (std::string(GetParam().file) + ".toml"));

  /// Random in the box of what single axes reach from home, advanced as far as it goes.
  Configuration random_configuration(std::mt19937& random) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int attempt = 0; attempt < 10000; ++attempt) {
      Configuration q = device->home();
      for (int k = 0; k < q.size(); ++k) {
        const ConfigurationAxis& axis = device->axes()[static_cast<std::size_t>(k)];
        const double far = (axis.angular ? 30.0 * deg : 8.0 * mm) * unit(random);
        q[k] = std::clamp(q[k] + far, axis.min, axis.max);
      }
      if (device->reachable(q)) return q;
    }
    return device->home();
  }
};

TEST_P(ForceCeilingOf, KeepsAStifferWearerBelowTheLimit) {
  const double limit = GetParam().force;
  const TravelCeiling ceiling = force_ceiling(*model, device, limit);
  Twin twin(stiffer(*model, kStiffestWearer), device);
  std::mt19937 random(7);
  double highest = 0.0;
  int lowered = 0;
  const int poses = device->degrees_of_freedom() > 6 ? 15 : 400;  // many pins take long
  for (int k = 0; k < poses; ++k) {
    Configuration q = random_configuration(random);
    if (ceiling.excess(q) > 0.0) ++lowered;
    ceiling.lower(q);
    twin.reset();
    twin.press(q, 0.0, 0.0);
    highest = std::max(highest, twin.contact().normal_force);
    EXPECT_LE(twin.contact().normal_force, limit) << q.transpose();
  }
  std::cout << GetParam().file << ": " << lowered << " of " << poses << " lowered, highest force "
            << highest << " N of " << limit << " N\n";
  // It limits, and not more than it has to.
  EXPECT_GT(lowered, 0);
  EXPECT_GE(highest, GetParam().reached * limit);
  if (device->approach_axis() < 0) return;  // pins have one ceiling for all
  // A ceiling that is far too low is as useless as one that is too high is dangerous: the device
  // would hover off the skin, and nobody be told. Where it can touch it may press, aside of home
  // and turned too.
  int touching = 0;
  int soft = 0;
  for (int k = 0; k < 100; ++k) {
    Configuration q = random_configuration(random);
    q[device->approach_axis()] = ceiling.travel(q);
    if (!device->reachable(q)) continue;
    ++touching;
    twin.reset();
    twin.press(q, 0.0, 0.0);
    if (twin.contact().normal_force < 0.3 * limit) ++soft;
  }
  EXPECT_GT(touching, 25);
  EXPECT_LE(soft, touching / 10);
}

// Of some sizes the first vertex to touch touches alone and hardly presses: no end of the search.
TEST(ForceCeiling, LetsFingersOfEverySizeBePressed) {
  const auto device = load_device(kProject / "devices" / "plate-2dof.toml");
  for (int k = 0; k <= 20; ++k) {
    auto finger = std::make_shared<FingerModel>(*index_finger());
    const FingerSize size = finger_size(*finger);
    const double scale = 0.90 + 0.01 * k;
    resize(*finger, {.length = *size.length * scale,
                     .breadth = *size.breadth * scale,
                     .depth = *size.depth * scale});
    constexpr double kLimit = 2.0;  // N
    const TravelCeiling ceiling = force_ceiling(*finger, device, kLimit);
    Configuration q = device->home();
    q[device->approach_axis()] = ceiling.travel(q);
    Twin twin(stiffer(*finger, kStiffestWearer), device);
    twin.press(q, 0.0, 0.0);
    EXPECT_LE(twin.contact().normal_force, kLimit) << scale;
    EXPECT_GT(twin.contact().normal_force, 0.5 * kLimit) << scale;
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, ForceCeilingOf,
                         ::testing::Values(LimitedDevice{"thimble-3rrs", 1.5, 0.9},
                                           LimitedDevice{"thimble-3rrs", 4.7, 0.9},
                                           LimitedDevice{"cable-prattichizzo", 1.5, 0.9},
                                           LimitedDevice{"delta-schorr", 0.5, 0.7},
                                           LimitedDevice{"five-bar", 2.0, 0.6},
                                           LimitedDevice{"strap-minamizawa", 4.0, 0.6},
                                           LimitedDevice{"slip-ball-webster", 3.0, 0.9},
                                           LimitedDevice{"slip-wheel-salada", 3.0, 0.9},
                                           LimitedDevice{"plate-2dof", 5.0, 0.8},
                                           LimitedDevice{"pins-wagner-6x6", 0.5, 0.85}),
                         [](const auto& each) {
                           std::string name = each.param.file;
                           std::erase(name, '-');
                           return name + (each.param.force > 2.0 ? "_far" : "");
                         });

TEST(ForceCeiling, IsTheSameWhateverTheThreadsDo) {
  const auto device = load_device(kProject / "devices" / "thimble-3rrs.toml");
  const TravelCeiling a = force_ceiling(*index_finger(), device, 2.0);
  const TravelCeiling b = force_ceiling(*index_finger(), device, 2.0);
  Configuration q = device->home();
  for (const double pitch : {-0.4, -0.1, 0.0, 0.25}) {
    for (const double roll : {-0.3, 0.0, 0.2}) {
      q[0] = pitch;
      q[1] = roll;
      EXPECT_EQ(a.travel(q), b.travel(q));
    }
  }
}

TEST(ForceCeiling, RefusesALimitThatRestExceeds) {
  auto model = std::make_shared<FingerModel>(*index_finger());
  for (Vector3& node : model->mesh.nodes) node.z() -= 6.0 * mm;
  const auto device = load_device(kProject / "devices" / "thimble-3rrs.toml");
  EXPECT_THROW(static_cast<void>(force_ceiling(*model, device, 0.2)), InputError);
}

}  // namespace
}  // namespace softfinger
