#include "draw.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace softfinger::relations {
namespace {

double from_environment(const char* name) {
  const char* text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nobody sets it
  return text != nullptr && *text != '\0' ? std::max(0.0, std::strtod(text, nullptr)) : 1.0;
}

}  // namespace

int cases(int usual) {
  return std::max(
      1, static_cast<int>(std::lround(usual * from_environment("SOFTFINGER_RELATIONS_SIZE"))));
}

Draw::Draw(std::string_view relation, int number)
    : state_(static_cast<std::uint64_t>(from_environment("SOFTFINGER_RELATIONS_SEED")) * 1000003U +
             static_cast<std::uint64_t>(number)) {
  for (const char letter : relation) {
    state_ = (state_ ^ static_cast<std::uint64_t>(letter)) * 1099511628211U;
  }
}

// Splitmix64 (Steele, Lea and Flood 2014).
std::uint64_t Draw::next() {
  state_ += 0x9e3779b97f4a7c15U;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31U);
}

double Draw::between(double least, double most) {
  return least + (most - least) * static_cast<double>(next() >> 11U) * 0x1p-53;
}

int Draw::below(int count) { return static_cast<int>(between(0.0, count)); }

Vector3 Draw::direction() {
  const double z = between(-1.0, 1.0);
  const double angle = between(0.0, 2.0 * std::numbers::pi);
  const double across = std::sqrt(1.0 - z * z);
  return {across * std::cos(angle), across * std::sin(angle), z};
}

Pose Draw::pose(double reach) {
  const Vector3 turn = between(0.2, 3.0) * direction();
  return {exp_rotation(turn), between(0.1, 1.0) * reach * direction()};
}

}  // namespace softfinger::relations
