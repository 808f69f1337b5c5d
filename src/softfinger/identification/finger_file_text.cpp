#include "softfinger/identification/finger_file_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kModulus = "youngs_modulus_kPa";

/// Six digits: more than any fit can tell, few enough to read.
double rounded(double value) {
  const double scale = std::pow(10.0, 5 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

bool is_bare(const std::string& key) {
  return !key.empty() && key.find_first_not_of(
                             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-") ==
                             std::string::npos;
}

/// A key as TOML; JSON's escapes are those of a basic string.
std::string key_text(const std::string& key) { return is_bare(key) ? key : Json(key).dump(); }

std::string relative_path(const std::filesystem::path& from_file, const std::string& written,
                          const std::filesystem::path& new_file) {
  namespace fs = std::filesystem;
  const fs::path target(written);
  if (target.is_absolute()) return written;
  const fs::path mesh = fs::weakly_canonical(from_file.parent_path() / target);
  const fs::path folder = fs::weakly_canonical(fs::absolute(new_file)).parent_path();
  const fs::path relative = mesh.lexically_relative(folder);
  return (relative.empty() ? mesh : relative).generic_string();
}

/// An array of tables, [[name]].
bool is_tables(const Json& value) {
  return value.is_array() && !value.empty() && value.front().is_object();
}

class Writer {
 public:
  explicit Writer(const std::map<std::string, std::string>& remarks) : remarks_(remarks) {}

  void table(const Json& table, const std::string& path, const std::string& header) {
    if (!path.empty()) text_ += fmt::format("\n[{}]\n", header);
    for (const auto& [key, value] : table.items()) {
      if (value.is_object() || is_tables(value)) continue;
      text_ += fmt::format("{} = {}", key_text(key), value.dump());
      const auto remark = remarks_.find(path.empty() ? key : path + "." + key);
      if (remark != remarks_.end()) text_ += "  # " + remark->second;
      text_ += '\n';
    }
    for (const auto& [key, value] : table.items()) {
      const std::string inner_path = path.empty() ? key : path + "." + key;
      const std::string inner = header.empty() ? key_text(key) : header + "." + key_text(key);
      if (value.is_object()) this->table(value, inner_path, inner);
      if (!is_tables(value)) continue;
      for (const Json& element : value) this->table(element, inner_path, "[" + inner + "]");
    }
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  const std::map<std::string, std::string>& remarks_;
  std::string text_;
};

}  // namespace

std::string finger_file_text(const FingerModel& model, const FingerConstants& constants,
                             const std::filesystem::path& new_file,
                             const std::vector<std::string>& head,
                             const std::map<std::string, std::string>& remarks) {
  Json keys = Json::parse(model.as_read);
  keys["mesh"]["file"] =
      relative_path(model.file, keys["mesh"]["file"].get<std::string>(), new_file);
  const auto scale = [&](Json& material) {
    if (!material.contains(kModulus)) return;
    material[kModulus] =
        rounded(material[kModulus].get<double>() * constants.youngs_modulus_factor);
  };
  scale(keys["material"]);
  for (auto& [name, value] : keys["material"].items()) {
    if (value.is_object()) scale(value);
  }
  if (model.strain_limits.stiffness > 0.0) {
    keys["strain_limits"]["min"] = rounded(constants.min);
    keys["strain_limits"]["max"] = rounded(constants.max);
  }
  Writer writer(remarks);
  writer.table(keys, "", "");
  std::string text;
  for (const std::string& line : head) text += "# " + line + '\n';
  return text + writer.text();
}

std::vector<std::pair<std::string, double>> youngs_moduli(const FingerModel& model) {
  const Json material = Json::parse(model.as_read)["material"];
  std::vector<std::pair<std::string, double>> moduli;
  if (material.contains(kModulus)) {
    moduli.emplace_back(fmt::format("material.{}", kModulus),
                        material[kModulus].get<double>() * kPa);
  }
  for (const auto& [name, value] : material.items()) {
    if (!value.is_object()) continue;
    moduli.emplace_back(fmt::format("material.{}.{}", name, kModulus),
                        value[kModulus].get<double>() * kPa);
  }
  return moduli;
}

}  // namespace softfinger
