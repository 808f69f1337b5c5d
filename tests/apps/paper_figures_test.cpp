// The explorations of Perez et al. 2015 (figures 1, 2 and 7), judged on what the program exports.

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "program.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using Row = std::map<std::string, double>;

/// Rows of a CSV file at the times `wanted` accepts; empty and non-numeric fields are NaN.
template <typename Wanted>
std::vector<Row> read_csv(const std::string& file, Wanted&& wanted) {
  std::ifstream stream(file);
  std::string line;
  std::vector<std::string> names;
  const auto split = [](const std::string& text, auto&& take) {
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      take(std::string_view(text).substr(begin, end - begin));
      begin = end + 1;
    }
  };
  std::getline(stream, line);
  split(line, [&](std::string_view name) { names.emplace_back(name); });
  std::vector<Row> rows;
  while (std::getline(stream, line)) {
    double time = 0.0;
    std::from_chars(line.data(), line.data() + line.size(), time);
    if (!wanted(time)) continue;
    Row row;
    std::size_t column = 0;
    split(line, [&](std::string_view field) {
      double value = NAN;
      std::from_chars(field.data(), field.data() + field.size(), value);
      row[names[column++]] = value;
    });
    rows.push_back(row);
  }
  return rows;
}

long step_of(double time_s) { return std::lround(time_s * 1000.0); }

/// What was known and answered at one device tick.
struct Frame {
  long step = 0;
  Pose X_WF;
  Configuration q;
  bool touches = false;
  Vector3 centroid_F;
};

/// Who explores: a finger's mesh, and what leads its device.
struct Explorer {
  const char* name;
  const char* finger;
  const char* objective;  ///< empty: as the device is shipped
};

std::ostream& operator<<(std::ostream& out, const Explorer& explorer) {
  return out << explorer.name;
}

class Exploration {
 public:
  Exploration(const Explorer& explorer, const std::string& scene, bool with_samples = false) {
    workplace_.replace_line("scenes/" + scene + ".toml", "model",
                            "model = \"../fingers/" + std::string(explorer.finger) + ".toml\"");
    if (*explorer.objective != '\0') {
      workplace_.replace_line("devices/thimble-3rrs.toml", "objective",
                              "objective = \"" + std::string(explorer.objective) + "\"");
    }
    const std::string recording = workplace_.path(scene + ".sqlite");
    folder_ = workplace_.path(scene);
    std::vector<std::string> run{"run",        workplace_.path("scenes/" + scene + ".toml"),
                                 "--headless", "--as-fast-as-possible",
                                 "--record",   recording};
    if (with_samples) run.emplace_back("--record-state");
    EXPECT_EQ(run_program(run).status, 0);
    EXPECT_EQ(run_program({"export", recording, "--to", folder_}).status, 0);
    const auto all = [](double) { return true; };
    std::map<long, Row> bone;
    std::map<long, Row> contact;
    for (const Row& row : read_csv(folder_ + "/bone.csv", all))
      bone[step_of(row.at("time_s"))] = row;
    for (const Row& row : read_csv(folder_ + "/contact.csv", all)) {
      contact[step_of(row.at("time_s"))] = row;
    }
    for (const Row& row : read_csv(folder_ + "/configuration.csv", all)) {
      Frame frame;
      frame.step = step_of(row.at("time_s"));
      if (!bone.contains(frame.step)) continue;
      const Row& b = bone[frame.step];
      const Row& c = contact[frame.step];
      frame.X_WF.rotation =
          Eigen::Quaterniond(b.at("qw"), b.at("qx"), b.at("qy"), b.at("qz")).toRotationMatrix();
      frame.X_WF.translation = Vector3(b.at("x_mm"), b.at("y_mm"), b.at("z_mm")) * mm;
      frame.q.resize(3);
      frame.q << row.at("wanted_pitch_deg") * deg, row.at("wanted_roll_deg") * deg,
          row.at("wanted_travel_mm") * mm;
      frame.touches = c.at("contact_samples") > 0.0;
      frame.centroid_F =
          Vector3(c.at("centroid_x_mm"), c.at("centroid_y_mm"), c.at("centroid_z_mm")) * mm;
      frames_.push_back(frame);
    }
  }

  [[nodiscard]] const std::vector<Frame>& frames() const { return frames_; }
  [[nodiscard]] Vector3 platform_normal_W(const Frame& frame) const {
    return frame.X_WF.rotation * device_->surface_pose(frame.q).rotation.col(2);
  }
  [[nodiscard]] const Device& device() const { return *device_; }

  /// Positions in F of the skin samples at one step, m.
  [[nodiscard]] std::map<long, std::vector<Vector3>> samples() const {
    std::map<long, std::vector<Vector3>> result;
    for (const Frame& frame : frames_) result[frame.step];
    for (const Row& row : read_csv(folder_ + "/samples.csv",
                                   [&](double time) { return result.contains(step_of(time)); })) {
      result[step_of(row.at("time_s"))].emplace_back(row.at("x_mm") * mm, row.at("y_mm") * mm,
                                                     row.at("z_mm") * mm);
    }
    return result;
  }

 private:
  Workplace workplace_;
  std::string folder_;
  std::shared_ptr<const Device> device_ = load_device(workplace_.path("devices/thimble-3rrs.toml"));
  std::vector<Frame> frames_;
};

double angle_deg(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / deg;
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values.at(static_cast<std::size_t>(q * static_cast<double>(values.size() - 1)));
}

class PaperFigures : public testing::TestWithParam<Explorer> {};

INSTANTIATE_TEST_SUITE_P(Explorers, PaperFigures,
                         testing::Values(Explorer{"shipped_S", "index", ""},
                                         Explorer{"shipped_M", "index-medium", ""},
                                         Explorer{"published_S", "index", "published"},
                                         Explorer{"published_M", "index-medium", "published"}),
                         [](const auto& one) { return one.param.name; });

/// Depth of the bone over the plane against travel, where the finger only moves up or down.
void expect_travel_grows_with_depth(const Frame& before, const Frame& frame) {
  if (angle_deg(frame.X_WF.rotation.col(2), before.X_WF.rotation.col(2)) >= 1e-3) return;
  if ((frame.X_WF.translation - before.X_WF.translation).head<2>().norm() >= 1e-6) return;
  const double deeper = before.X_WF.translation.z() - frame.X_WF.translation.z();
  const double travel = frame.q[2] - before.q[2];
  if (std::abs(deeper) > 0.02e-3) {
    EXPECT_GT(travel * deeper, 0.0) << "step " << frame.step;
  }
}

void expect_smooth(const Frame& before, const Frame& frame) {
  const double bone_motion = (frame.X_WF.translation - before.X_WF.translation).norm() / mm;
  const double bone_turn = angle_deg(
      Eigen::AngleAxisd(frame.X_WF.rotation * before.X_WF.rotation.transpose()).toRotationMatrix() *
          Vector3::UnitZ(),
      Vector3::UnitZ());
  EXPECT_LE(std::abs(frame.q[2] - before.q[2]) / mm, 0.15 + bone_motion) << frame.step;
  EXPECT_LE((frame.q - before.q).head<2>().norm() / deg, 2.0 + bone_turn) << frame.step;
}

TEST_P(PaperFigures, OnThePlaneThePlatformIsThePlaneAndFollowsDepthSmoothly) {
  const Exploration plane(GetParam(), "plane");
  // A constant separation pushes the disk's rim off the skin that hovers beside the contact.
  const double most = std::string(GetParam().objective) == "published" ? 1.3 : 1.0;
  int touching = 0;
  const Frame* before = nullptr;
  for (const Frame& frame : plane.frames()) {
    if (frame.touches) {
      ++touching;
      EXPECT_LT(angle_deg(plane.platform_normal_W(frame), Vector3::UnitZ()), most) << frame.step;
      if (before != nullptr && before->touches) {
        expect_travel_grows_with_depth(*before, frame);
        expect_smooth(*before, frame);
      }
    }
    before = &frame;
  }
  EXPECT_GT(touching, 100);
}

TEST_P(PaperFigures, OnTheSphereThePlatformFacesTheSphereUnderTheContact) {
  const Exploration sphere(GetParam(), "sphere");
  std::vector<double> angles;
  for (const Frame& frame : sphere.frames()) {
    if (!frame.touches) continue;
    EXPECT_TRUE(sphere.device().reachable(frame.q)) << frame.step;
    // The ball is about the origin of the world.
    const Vector3 normal_W = (frame.X_WF * frame.centroid_F).normalized();
    angles.push_back(angle_deg(sphere.platform_normal_W(frame), normal_W));
  }
  ASSERT_GT(angles.size(), 100U);
  EXPECT_LT(quantile(angles, 0.5), 5.0);
}

TEST_P(PaperFigures, OnTheEdgeThePlatformTipsToTheFreeSideAndSparesTheSkinBeyond) {
  const Exploration edge(GetParam(), "edge", true);
  const auto samples = edge.samples();
  std::vector<double> tips;
  int frames = 0;
  int spared = 0;
  for (const Frame& frame : edge.frames()) {
    // The edge runs along y at x = 0; the pad's centre lies under F's origin.
    if (!frame.touches || std::abs(frame.X_WF.translation.x()) > 1.5 * mm) continue;
    const Vector3 normal_W = edge.platform_normal_W(frame);
    tips.push_back(std::atan2(normal_W.x(), normal_W.z()) / deg);
    double indentation = 0.0;
    double deepest = 0.0;
    for (const Vector3& p_F : samples.at(frame.step)) {
      const Vector3 p_W = frame.X_WF * p_F;
      // How far the skin that lies free hangs below the face that carries the rest of it.
      if (p_W.x() <= 0.0) continue;
      indentation = std::max(indentation, -p_W.z());
      deepest = std::max(deepest, -edge.device().signed_distance(frame.q, p_F).distance);
    }
    ++frames;
    if (deepest <= 0.6 * indentation) ++spared;
  }
  ASSERT_GT(frames, 20);
  EXPECT_GE(quantile(tips, 0.5), 3.0);
  EXPECT_GE(spared, 0.9 * frames);
}

}  // namespace
}  // namespace softfinger
