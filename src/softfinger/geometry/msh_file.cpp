#include "softfinger/geometry/msh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <unordered_map>

#include "softfinger/base/error.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/geometry/tetrahedron_faces.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kMaxFileSize = 512u << 20;  // bytes
constexpr std::size_t kMaxNodes = 2'000'000;
constexpr std::size_t kMaxElements = 8'000'000;
/// Least 6 V / (longest edge)^3 of a tetrahedron; 0.707 for a regular one.
constexpr double kMinVolumeRatio = 1e-5;

enum ElementType { kLine = 1, kTriangle = 2, kTetrahedron = 4, kPoint = 15 };

struct Element {
  std::array<int, 4> nodes{};  // indices into the file's nodes; triangles use three
  int group = 0;               // physical tag
  std::int64_t number = 0;     // as the file counts
  std::size_t line = 0;
};

/// Walks through the lines of a text and speaks of errors in them.
class Lines {
 public:
  Lines(std::string file, std::string_view text) : file_(std::move(file)), rest_(text) {}

  /// The next line that is not blank; nothing at the end.
  std::optional<std::string_view> next() {
    while (!rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      std::string_view line = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      ++number_;
      while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) {
        line.remove_suffix(1);
      }
      if (!line.empty()) return line;
    }
    return std::nullopt;
  }
  std::string_view require(std::string_view section) {
    const auto line = next();
    if (!line) fail(fmt::format("the file ends inside ${}: it is truncated", section));
    return *line;
  }
  [[nodiscard]] std::size_t number() const { return number_; }
  [[nodiscard]] std::size_t bytes_left() const { return rest_.size(); }
  [[noreturn]] void fail(std::string_view message) const { fail_at(number_, message); }
  [[noreturn]] void fail_at(std::size_t line, std::string_view message) const {
    throw InputError(fmt::format("{}:{}: {}", file_, line, message));
  }
  [[noreturn]] void fail_file(std::string_view message) const {
    throw InputError(fmt::format("{}: {}", file_, message));
  }
  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  std::string file_;
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// Takes the next number off the front of a line; false where there is none.
template <typename Number>
bool take(std::string_view& line, Number& value) {
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return false;
  line.remove_prefix(begin);
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
  if (error != std::errc()) return false;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  return line.empty() || line.front() == ' ' || line.front() == '\t';
}

class MshReader {
 public:
  MshReader(const std::filesystem::path& file, std::string_view text)
      : lines_(file.string(), text) {}

  TetrahedralMesh read(double scale) {
    read_sections();
    if (node_of_id_.empty()) lines_.fail_file("has no $Nodes");
    if (tetrahedra_.empty()) {
      lines_.fail_file(triangles_.empty()
                           ? "has no tetrahedra"
                           : "has no tetrahedra: it is a surface mesh; fill it with a volume mesh");
    }
    for (const Element& element : tetrahedra_) check_shape(element);
    return build(scale);
  }

 private:
  void read_sections() {
    bool format_seen = false;
    while (const auto line = lines_.next()) {
      if (line->front() != '$') {
        lines_.fail(format_seen ? "expected a section such as $Nodes"
                                : "is not a Gmsh MSH file: expected $MeshFormat");
      }
      const std::string section(line->substr(1));
      if (section == "MeshFormat") {
        read_format();
        format_seen = true;
      } else if (section == "Comments") {
        skip(section);
      } else if (!format_seen) {
        lines_.fail("is not a Gmsh MSH 2.2 file: expected $MeshFormat first");
      } else if (section == "PhysicalNames") {
        read_names();
      } else if (section == "Nodes") {
        read_nodes();
      } else if (section == "Elements") {
        read_elements();
      } else {
        skip(section);
      }
    }
    if (!format_seen) lines_.fail_file("is not a Gmsh MSH file: it is empty");
  }

  void skip(const std::string& section) {
    const std::string end = "$End" + section;
    while (lines_.require(section) != end) {
    }
  }

  void end_section(std::string_view section) {
    if (lines_.require(section) != fmt::format("$End{}", section)) {
      lines_.fail(
          fmt::format("expected $End{}: more lines than the count of ${} says", section, section));
    }
  }

  [[nodiscard]] std::string how_to_convert() const {
    return fmt::format("convert it with: gmsh {} -save -format msh22 -o converted.msh",
                       lines_.file());
  }

  void read_format() {
    std::string_view line = lines_.require("MeshFormat");
    double version = 0.0;
    int file_type = 0;
    if (!take(line, version) || !take(line, file_type)) {
      lines_.fail("expected the version and type of the file, as in 2.2 0 8");
    }
    if (version < 2.0 || version >= 3.0) {
      lines_.fail(fmt::format("is MSH version {}, expected 2.2; {}", version, how_to_convert()));
    }
    if (file_type != 0) lines_.fail("is a binary MSH file, expected ASCII; " + how_to_convert());
    end_section("MeshFormat");
  }

  std::size_t read_count(std::string_view section, std::size_t max) {
    std::string_view line = lines_.require(section);
    std::size_t count = 0;
    if (!take(line, count)) lines_.fail(fmt::format("expected the count of ${}", section));
    if (count > max) {
      lines_.fail(fmt::format("${} has {} entries, at most {} are read", section, count, max));
    }
    return count;
  }

  void read_names() {
    const std::size_t count = read_count("PhysicalNames", 100'000);
    for (std::size_t i = 0; i < count; ++i) {
      std::string_view line = lines_.require("PhysicalNames");
      int dimension = 0, tag = 0;
      const bool numbers = take(line, dimension) && take(line, tag);
      const std::size_t open = line.find('"');
      const std::size_t close = line.rfind('"');
      if (!numbers || open == std::string_view::npos || close <= open) {
        lines_.fail("expected dimension, number and \"name\" of a physical group");
      }
      names_[{dimension, tag}] = std::string(line.substr(open + 1, close - open - 1));
    }
    end_section("PhysicalNames");
  }

  void read_nodes() {
    if (!node_of_id_.empty()) lines_.fail("a second $Nodes section");
    const std::size_t count = read_count("Nodes", kMaxNodes);
    // Counts are not trusted for memory: a line of a node has at least 8 bytes.
    const std::size_t reserved = std::min(count, lines_.bytes_left() / 8);
    points_.reserve(reserved);
    node_of_id_.reserve(reserved);
    for (std::size_t i = 0; i < count; ++i) {
      std::string_view line = lines_.require("Nodes");
      std::int64_t id = 0;
      Vector3 point;
      if (!take(line, id) || !take(line, point.x()) || !take(line, point.y()) ||
          !take(line, point.z())) {
        lines_.fail(fmt::format("expected number, x, y and z of node {} of {}", i + 1, count));
      }
      if (!point.allFinite()) lines_.fail(fmt::format("node {} has a coordinate not finite", id));
      if (!node_of_id_.emplace(id, static_cast<int>(points_.size())).second) {
        lines_.fail(fmt::format("node {} is given twice", id));
      }
      points_.push_back(point);
      ids_.push_back(id);
    }
    end_section("Nodes");
  }

  void read_elements() {
    const std::size_t count = read_count("Elements", kMaxElements);
    for (std::size_t i = 0; i < count; ++i) {
      std::string_view line = lines_.require("Elements");
      Element element;
      int type = 0, tags = 0;
      if (!take(line, element.number) || !take(line, type) || !take(line, tags) || tags < 0 ||
          tags > 1000) {
        lines_.fail(
            fmt::format("expected number, type and tags of element {} of {}", i + 1, count));
      }
      for (int tag = 0; tag < tags; ++tag) {
        int value = 0;
        if (!take(line, value)) lines_.fail("expected as many tags as the element announces");
        if (tag == 0) element.group = value;
      }
      element.line = lines_.number();
      if (type == kPoint || type == kLine) continue;
      if (type != kTriangle && type != kTetrahedron) {
        lines_.fail(
            fmt::format("element {} has type {}; only triangles (2) and tetrahedra (4) of "
                        "first order are read",
                        element.number, type));
      }
      const std::size_t size = type == kTriangle ? 3 : 4;
      for (std::size_t k = 0; k < size; ++k) {
        std::int64_t id = 0;
        if (!take(line, id)) lines_.fail(fmt::format("expected {} nodes of the element", size));
        const auto node = node_of_id_.find(id);
        if (node == node_of_id_.end()) {
          lines_.fail(
              fmt::format("element {} names node {}, which is not in $Nodes", element.number, id));
        }
        element.nodes[k] = node->second;
      }
      if (type == kTetrahedron) {
        tetrahedra_.push_back(element);
      } else if (element.group != 0) {  // 0: in no physical group
        triangles_.push_back(element);
      }
    }
    end_section("Elements");
  }

  void check_shape(const Element& element) const {
    std::array<Vector3, 4> p;
    for (std::size_t k = 0; k < 4; ++k) p[k] = points_[static_cast<std::size_t>(element.nodes[k])];
    double longest = 0.0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < a; ++b) longest = std::max(longest, (p[a] - p[b]).norm());
    }
    const double ratio =
        (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) / (longest * longest * longest);
    if (ratio > kMinVolumeRatio) return;
    const bool inverted = ratio < -kMinVolumeRatio;
    lines_.fail_at(element.line,
                   fmt::format("tetrahedron {} is {}", element.number,
                               inverted ? "inverted: its nodes are in left-handed order"
                                        : "degenerate: its volume is nearly zero"));
  }

  [[nodiscard]] std::string list_ids(const std::vector<int>& nodes) const {
    std::string text;
    for (const int node : nodes) {
      text += fmt::format("{}{}", text.empty() ? "" : ", ", ids_[static_cast<std::size_t>(node)]);
    }
    return text;
  }

  int name_index(std::vector<std::string>& names, int dimension, int tag) const {
    const auto named = names_.find({dimension, tag});
    std::string name = tag == 0 ? std::string() : fmt::format("{}", tag);
    if (named != names_.end()) name = named->second;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<int>(found - names.begin());
    names.push_back(std::move(name));
    return static_cast<int>(names.size()) - 1;
  }

  TetrahedralMesh build(double scale) const {
    TetrahedralMesh mesh;
    std::vector<int> new_index(points_.size(), -1);
    for (const Element& element : tetrahedra_) {
      for (const int node : element.nodes) new_index[static_cast<std::size_t>(node)] = 0;
    }
    std::vector<int> old_index;
    for (std::size_t node = 0; node < points_.size(); ++node) {
      if (new_index[node] < 0) continue;
      new_index[node] = static_cast<int>(mesh.nodes.size());
      mesh.nodes.push_back(scale * points_[node]);
      old_index.push_back(static_cast<int>(node));
    }
    for (const Element& element : tetrahedra_) {
      Tetrahedron tetrahedron;
      for (std::size_t k = 0; k < 4; ++k) {
        tetrahedron[k] = new_index[static_cast<std::size_t>(element.nodes[k])];
      }
      mesh.tetrahedra.push_back(tetrahedron);
      mesh.tetrahedron_volume.push_back(name_index(mesh.volume_names, 3, element.group));
    }
    const std::vector<TetrahedronFace> faces = faces_of(mesh.tetrahedra);
    MeshDefect defect = find_boundary_defect(faces);
    if (!defect.message.empty()) {
      for (int& node : defect.nodes) node = old_index[static_cast<std::size_t>(node)];
      const Element& element = tetrahedra_[static_cast<std::size_t>(defect.tetrahedron)];
      lines_.fail_at(element.line,
                     fmt::format("tetrahedron {}: {} (node{} {})", element.number, defect.message,
                                 defect.nodes.size() > 1 ? "s" : "", list_ids(defect.nodes)));
    }
    for (const Element& element : triangles_) {
      Triangle triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        triangle[k] = new_index[static_cast<std::size_t>(element.nodes[k])];
      }
      const auto face = find_face(faces, triangle);
      if (face.empty()) {
        lines_.fail_at(element.line,
                       fmt::format("triangle {} is no face of a tetrahedron", element.number));
      }
      mesh.triangles.push_back(face.front().outward);
      mesh.triangle_surface.push_back(name_index(mesh.surface_names, 2, element.group));
    }
    return mesh;
  }

  Lines lines_;
  std::map<std::pair<int, int>, std::string> names_;  // by dimension and tag
  std::unordered_map<std::int64_t, int> node_of_id_;
  std::vector<Vector3> points_;
  std::vector<std::int64_t> ids_;
  std::vector<Element> triangles_, tetrahedra_;
};

}  // namespace

TetrahedralMesh read_msh(const std::filesystem::path& file, double scale) {
  const std::string text = read_text_file(file, kMaxFileSize);
  return MshReader(file, text).read(scale);
}

}  // namespace softfinger
