#include "contact_points_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"

namespace {

using nlohmann::json;
using softfinger::InputError;

constexpr std::size_t kMaxBytes = 16 << 20;
constexpr std::size_t kMaxPoints = 100000;

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file.string()) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(file_ + ": cannot be read");
    std::string text(std::istreambuf_iterator<char>(stream), {});
    if (text.size() > kMaxBytes) throw InputError(file_ + ": larger than 16 MB");
    try {
      root_ = json::parse(text);
    } catch (const json::parse_error& error) {
      const auto end = text.begin() + static_cast<long>(std::min(error.byte, text.size()));
      throw InputError(
          fmt::format("{}:{}: not valid JSON", file_, 1 + std::count(text.begin(), end, '\n')));
    } catch (const json::out_of_range&) {
      throw InputError(file_ + ": has a number too large to be represented");
    }
    if (!root_.is_object()) throw InputError(file_ + ": must be a JSON object");
    const std::vector<std::string> known{"points_mm", "in_contact", "area_mm2", "distance_mm",
                                         "separation_tolerance_mm"};
    for (const auto& [key, value] : root_.items()) {
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      const std::string near = softfinger::nearest_word(key, known);
      fail(key, near.empty() ? "unknown key" : "unknown key; did you mean '" + near + "'?");
    }
  }

  [[noreturn]] void fail(const std::string& key, const std::string& message) const {
    throw InputError(file_ + ": " + key + ": " + message);
  }

  [[nodiscard]] bool has(const char* key) const { return root_.contains(key); }

  [[nodiscard]] const json& array(const char* key) const {
    if (!has(key)) fail(key, "missing");
    if (!root_[key].is_array()) fail(key, "must be an array");
    return root_[key];
  }

  [[nodiscard]] double number(const json& value, const std::string& key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      fail(key, "must be a finite number");
    }
    return value.get<double>();
  }

  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count,
                                            bool may_be_negative, bool may_be_zero) const {
    const json& values = array(key);
    check_length(key, values.size(), count);
    std::vector<double> result;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::string name = fmt::format("{}[{}]", key, i);
      const double v = number(values[i], name);
      if (!may_be_negative && v < 0.0) fail(name, fmt::format("{} is negative", v));
      if (!may_be_zero && v == 0.0) fail(name, "must be above 0");
      result.push_back(v * softfinger::unit_scale(key));
    }
    return result;
  }

  void check_length(const char* key, std::size_t length, std::size_t count) const {
    if (length == count) return;
    fail(key, fmt::format("has {} entries, points_mm has {}; they must agree", length, count));
  }

  [[nodiscard]] const json& root() const { return root_; }

 private:
  std::string file_;
  json root_;
};

}  // namespace

ContactPointsFile read_contact_points(const std::filesystem::path& file) {
  const Reader reader(file);
  ContactPointsFile result;
  const json& points = reader.array("points_mm");
  if (points.empty()) reader.fail("points_mm", "has no points");
  if (points.size() > kMaxPoints) reader.fail("points_mm", "has more than 100000 points");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string name = fmt::format("points_mm[{}]", i);
    if (!points[i].is_array() || points[i].size() != 3) reader.fail(name, "must be [x, y, z]");
    softfinger::Vector3 p;
    for (int k = 0; k < 3; ++k) {
      p[k] = reader.number(points[i][static_cast<std::size_t>(k)], name) * softfinger::mm;
    }
    result.points_F.push_back(p);
  }
  const json& flags = reader.array("in_contact");
  reader.check_length("in_contact", flags.size(), points.size());
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (!flags[i].is_boolean()) {
      reader.fail(fmt::format("in_contact[{}]", i), "must be true or false");
    }
    result.in_contact.push_back(flags[i].get<bool>() ? 1 : 0);
  }
  if (reader.has("area_mm2"))
    result.areas = reader.numbers("area_mm2", points.size(), false, false);
  if (reader.has("distance_mm")) {
    result.gaps = reader.numbers("distance_mm", points.size(), true, true);
  }
  if (reader.has("separation_tolerance_mm")) {
    const double eps =
        reader.number(reader.root()["separation_tolerance_mm"], "separation_tolerance_mm");
    if (eps < 0.0) reader.fail("separation_tolerance_mm", fmt::format("{} is negative", eps));
    result.separation_tolerance = eps * softfinger::mm;
  }
  return result;
}
