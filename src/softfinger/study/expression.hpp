#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger {

/// A formula such as "2 * device.geometry.crank_mm + 1" over named numbers; with + - * / ^, sin,
/// sqrt, min, max and the like, pi.
class Expression {
 public:
  /// What stands for a name: the place of a variable among those given to value(), or a constant.
  struct Meaning {
    std::size_t variable = kNone;
    double constant = 0.0;
    static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  };
  /// Empty: there is no such number.
  using Names = std::function<std::optional<Meaning>(std::string_view name)>;

  /// Throws InputError, without a place, where it is none or names what there is not.
  Expression(const std::string& text, const Names& names);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;

  /// NaN where it is not defined. One thread.
  [[nodiscard]] double value(const std::vector<double>& variables) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softfinger
