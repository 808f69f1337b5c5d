// What does not touch does not matter: islands, and the matrix of bodies that touch few others.
#include "softfinger/world/islands.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "play.hpp"
#include "softfinger/threads/thread_team.hpp"
#include "softfinger/world/body_cholesky.hpp"

namespace softfinger {
namespace {

std::vector<std::size_t> list(std::span<const std::size_t> numbers) {
  return {numbers.begin(), numbers.end()};
}

TEST(Islands, AreInTheOrderOfTheirLeastNumbersWithMembersInOrder) {
  Islands islands(8);
  islands.begin();
  for (const std::size_t n : {0U, 1U, 2U, 4U, 5U, 6U, 7U}) islands.take(n);
  islands.join(6, 4);
  islands.join(2, 6);
  islands.join(7, 0);
  islands.join(3, 1);  // 3 takes no part
  islands.find();
  ASSERT_EQ(islands.size(), 4U);
  EXPECT_EQ(list(islands.members(0)), (std::vector<std::size_t>{0, 7}));
  EXPECT_EQ(list(islands.members(1)), (std::vector<std::size_t>{1}));
  EXPECT_EQ(list(islands.members(2)), (std::vector<std::size_t>{2, 4, 6}));
  EXPECT_EQ(list(islands.members(3)), (std::vector<std::size_t>{5}));
  EXPECT_EQ(islands.island_of(6), 2);
  EXPECT_EQ(islands.island_of(3), -1);
  islands.begin();
  islands.find();
  EXPECT_EQ(islands.size(), 0U);
}

/// The same system with all its blocks, and a random one with these pairs of bodies coupled.
class Coupled {
 public:
  Coupled(std::vector<int> freedoms, const std::vector<std::pair<std::size_t, std::size_t>>& pairs)
      : freedoms_(std::move(freedoms)), dense_(6 * size(), 6 * size()) {
    sparse_.reserve(freedoms_.size());
    sparse_.begin(freedoms_.size());
    for (const auto& [a, b] : pairs) sparse_.couple(a, b);
    sparse_.arrange();
    sparse_.clear(freedoms_);
    dense_.setIdentity();
    for (std::size_t a = 0; a < freedoms_.size(); ++a) add(a, a, 20.0);
    for (const auto& [a, b] : pairs) add(a, b, 0.0);
  }
  void add(std::size_t a, std::size_t b, double diagonal) {
    for (int r = 0; r < freedoms_[a]; ++r) {
      for (int c = a == b ? r : 0; c < freedoms_[b]; ++c) {
        const double value = part_(random_) + (a == b && r == c ? diagonal : 0.0);
        const auto i = static_cast<Eigen::Index>(6 * a) + r;
        const auto j = static_cast<Eigen::Index>(6 * b) + c;
        dense_(i, j) = dense_(j, i) = value;
        sparse_.add(a, r, b, c, value);
        if (a == b && r != c) sparse_.add(a, c, b, r, value);
      }
    }
  }
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(freedoms_.size()); }
  double error() {
    EXPECT_TRUE(sparse_.factor());
    Eigen::VectorXd x = Eigen::VectorXd::Random(6 * size());
    const Eigen::VectorXd wanted = dense_.llt().solve(x);
    const Eigen::VectorXd before = x;
    sparse_.solve({x.data(), static_cast<std::size_t>(x.size())});
    double most = 0.0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const bool used = i % 6 < freedoms_[static_cast<std::size_t>(i / 6)];
      most = std::max(most, std::abs(x[i] - (used ? wanted[i] : before[i])));
    }
    return most;
  }
  [[nodiscard]] BodyCholesky& sparse() { return sparse_; }

 private:
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> part_{-1.0, 1.0};
  std::vector<int> freedoms_;
  Eigen::MatrixXd dense_;
  BodyCholesky sparse_;
};

TEST(BodyCholesky, SolvesWhatTheDenseFactorSolves) {
  EXPECT_LT(Coupled({6}, {}).error(), 1e-14);
  EXPECT_LT(Coupled({6, 1, 3, 6, 6}, {{0, 1}, {3, 1}, {4, 2}, {2, 0}}).error(), 1e-14);
  // A ring fills up within.
  Coupled ring({6, 6, 3, 6, 6, 1, 6}, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 0}});
  EXPECT_LT(ring.error(), 1e-14);
  EXPECT_GT(ring.sparse().filled(), 14U);
}

TEST(BodyCholesky, BonesAroundAnObjectFillNothing) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t bone = 1; bone < 15; ++bone) pairs.emplace_back(0, bone);
  Coupled held(std::vector<int>(15, 6), pairs);
  EXPECT_EQ(held.sparse().filled(), 15U + 14U);
  EXPECT_LT(held.error(), 1e-14);
}

TEST(BodyCholesky, SaysWhatIsNotPositiveDefinite) {
  Coupled two({6, 6}, {{0, 1}});
  two.sparse().add(1, 2, 1, 2, -1e3);
  EXPECT_FALSE(two.sparse().factor());
}

VirtualObject box_at(const char* name, const Vector3& at, const Vector3& velocity) {
  VirtualObject box = loose(name, RoundedBox{Vector3(10, 12, 8) * mm, 1.0 * mm}, at, 0.05);
  box.dynamics->velocity_W = velocity;
  box.dynamics->angular_velocity_W = Vector3(3.0, -2.0, 1.0);
  return box;
}

/// Two boxes that fall on each other, and others far from them.
Play fallen(bool with_others, ThreadTeam* team = nullptr) {
  std::vector<VirtualObject> objects{still("ground", HalfSpace{}),
                                     box_at("low", Vector3(0, 0, 20 * mm), Vector3(0.2, 0, 0)),
                                     box_at("high", Vector3(4 * mm, 0, 60 * mm), Vector3::Zero())};
  if (with_others) {
    for (const double x : {0.3, 0.6, 0.9}) {
      objects.push_back(box_at("other", Vector3(x, 0, 0.1), Vector3(0, 0.3, 0)));
      objects.push_back(box_at("another", Vector3(x, 5 * mm, 0.14), Vector3(0, 0.2, 0)));
    }
  }
  return Play(objects, kDown, {}, team);
}

TEST(Islands, MoveAsIfNothingElseWereThere) {
  Play few = fallen(false);
  Play many = fallen(true);
  long own = 0;
  for (int k = 0; k < 1500; ++k) {
    few.step();
    many.step();
    for (const std::size_t o : {1U, 2U}) {
      ASSERT_EQ(few.state(o).X_WO.translation, many.state(o).X_WO.translation) << k;
      ASSERT_EQ(few.state(o).X_WO.rotation, many.state(o).X_WO.rotation) << k;
      ASSERT_EQ(few.state(o).velocity, many.state(o).velocity) << k;
    }
    own += few.world().work().evaluations;
  }
  EXPECT_GT(own, 3000);
}

TEST(Islands, CostTheSumOfWhatEachCostsAlone) {
  // Boxes at rest take few evaluations whatever another island is at.
  const auto evaluations = [](bool with_resting, bool with_fallen) {
    std::vector<VirtualObject> objects{still("ground", HalfSpace{})};
    if (with_resting) {
      for (int i = 0; i < 6; ++i) {
        objects.push_back(box_at("resting", Vector3(0.1 * i, 0.5, 8.0 * mm), Vector3::Zero()));
        objects.back().dynamics->angular_velocity_W.setZero();
      }
    }
    if (with_fallen) {
      objects.push_back(box_at("low", Vector3(0, 0, 20 * mm), Vector3(0.2, 0, 0)));
      objects.push_back(box_at("high", Vector3(4 * mm, 0, 60 * mm), Vector3::Zero()));
    }
    Play play(objects);
    long sum = 0;
    for (int k = 0; k < 300; ++k) {
      play.step();
      sum += play.world().work().evaluations;
    }
    return sum;
  };
  EXPECT_EQ(evaluations(true, true), evaluations(true, false) + evaluations(false, true));
}

TEST(Islands, GiveTheSameBitsOnAnyNumberOfThreads) {
  ThreadTeam two(2);
  ThreadTeam three(3);
  Play alone = fallen(true);
  Play with_two = fallen(true, &two);
  Play with_three = fallen(true, &three);
  for (int k = 0; k < 15; ++k) {
    for (Play* play : {&alone, &with_two, &with_three}) play->run(0.1);
    EXPECT_EQ(alone.world().state_hash(), with_two.world().state_hash()) << k;
    EXPECT_EQ(alone.world().state_hash(), with_three.world().state_hash()) << k;
  }
}

/// Two fingers, each on a cube of its own 40 mm from the other: three threads' worth of islands.
Play two_pressed(bool both, ThreadTeam* team = nullptr) {
  const RoundedBox cube{Vector3(12, 12, 10) * mm, 1.0 * mm};
  std::vector<VirtualObject> objects{still("ground", HalfSpace{}, Vector3(0, 0, -20.0 * mm)),
                                     loose("one", cube, Vector3(0, 0, -10.0 * mm), 0.05)};
  const auto press = [](double x) {
    return [x](double time) {
      return Pose{Matrix3::Identity(),
                  Vector3(x + 2.0 * mm * smooth(time, 0.2, 0.4), 0.0,
                          kPad + 0.5 * mm - 1.5 * mm * smooth(time, 0.0, 0.2))};
    };
  };
  std::vector<Play::Path> paths{press(0.0)};
  if (both) {
    objects.push_back(loose("other", cube, Vector3(80.0 * mm, 0, -10.0 * mm), 0.05));
    paths.emplace_back(press(80.0 * mm));
  }
  return Play(objects, kDown, paths, team);
}

TEST(Islands, OfFingersDoNotKnowOfEachOther) {
  ThreadTeam team(2);
  Play one = two_pressed(false);
  Play two = two_pressed(true, &team);
  for (int k = 0; k < 400; ++k) {
    one.step();
    two.step();
    ASSERT_EQ(one.finger(0).bone_pose().translation, two.finger(0).bone_pose().translation) << k;
    ASSERT_EQ(one.state(1).X_WO.translation, two.state(1).X_WO.translation) << k;
  }
  EXPECT_GT(one.finger(0).contact().normal_force, 0.1);
  EXPECT_EQ(two.world().work().islands, 2U);
}

}  // namespace
}  // namespace softfinger
