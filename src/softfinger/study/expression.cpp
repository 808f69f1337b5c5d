#include "softfinger/study/expression.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <cmath>
#include <deque>
#include <numbers>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

constexpr const char* kNameCharacters =
    "0123456789_.abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";

}  // namespace

struct Expression::Impl {
  struct Variable {
    Meaning meaning;
    double value = 0.0;
  };
  mu::Parser parser;
  std::deque<Variable> variables;  ///< the parser has their addresses
};

Expression::Expression(const std::string& text, const Names& names)
    : impl_(std::make_unique<Impl>()) {
  mu::Parser& parser = impl_->parser;
  try {
    parser.DefineNameChars(kNameCharacters);
    parser.DefineConst("pi", std::numbers::pi);
    parser.SetExpr(text);
    const mu::varmap_type used = parser.GetUsedVar();
    for (const auto& [name, unset] : used) {
      const std::optional<Meaning> meaning = names(name);
      if (!meaning) throw InputError(fmt::format("there is no number {}", name));
      impl_->variables.push_back({*meaning, meaning->constant});
      parser.DefineVar(name, &impl_->variables.back().value);
    }
    static_cast<void>(parser.Eval());
  } catch (const mu::Parser::exception_type& error) {
    throw InputError(fmt::format(
        "'{}' is no formula that can be read{}", text,
        error.GetToken().empty() ? "" : fmt::format(", from '{}' on", error.GetToken())));
  }
}

Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

double Expression::value(const std::vector<double>& variables) const {
  for (Impl::Variable& variable : impl_->variables) {
    if (variable.meaning.variable != Meaning::kNone) {
      variable.value = variables[variable.meaning.variable];
    }
  }
  try {
    const double value = impl_->parser.Eval();
    return std::isfinite(value) ? value : std::nan("");
  } catch (const mu::Parser::exception_type&) {
    return std::nan("");  // of a function outside its domain
  }
}

}  // namespace softfinger
