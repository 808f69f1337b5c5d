#include "softfinger/study/case.hpp"

#include <algorithm>
#include <cstring>

namespace softfinger {
namespace {

/// Numbers after a whole one, as they lie in memory: ranks of one study are alike.
std::string packed(std::uint32_t number, const std::vector<double>& values) {
  std::string bytes(sizeof number + values.size() * sizeof(double), '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  if (!values.empty()) {
    std::memcpy(bytes.data() + sizeof number, values.data(), values.size() * sizeof(double));
  }
  return bytes;
}

std::uint32_t number_in(std::string_view bytes) {
  std::uint32_t number = 0;
  if (bytes.size() >= sizeof number) std::memcpy(&number, bytes.data(), sizeof number);
  return number;
}

std::vector<double> doubles_in(std::string_view bytes) {
  std::vector<double> values(bytes.size() / sizeof(double));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(double));
  return values;
}

}  // namespace

std::string StudyCase::bytes() const { return packed(person, design); }

StudyCase StudyCase::of_bytes(std::string_view bytes) {
  return {doubles_in(bytes.substr(std::min<std::size_t>(4, bytes.size()))), number_in(bytes)};
}

std::string CaseOutcome::bytes() const {
  return packed(static_cast<std::uint32_t>(values.size()), values) + reason;
}

CaseOutcome CaseOutcome::of_bytes(std::string_view bytes) {
  const std::size_t end = std::min(4 + sizeof(double) * number_in(bytes), bytes.size());
  return {std::string(bytes.substr(end)), doubles_in(bytes.substr(4, end - 4))};
}

}  // namespace softfinger
