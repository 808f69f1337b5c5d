#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "softfinger/viewer/page_request.hpp"

// Whatever a page asks: it is refused, or names a scene that there is, or has a pose that is
// finite, rigid and within a metre, or lengths that are a finger's and a table's.
extern "C" int fuzz_page_request(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  static const std::array<std::string, 2> kScenes = {"sphere", "edge"};
  const std::string_view message(reinterpret_cast<const char*>(data), size);
  const auto request = parse_page_request(message, kScenes);
  if (!request) return 0;
  if (request->kind == LiveRequest::Kind::kScene && request->scene != kScenes[0] &&
      request->scene != kScenes[1]) {
    __builtin_trap();
  }
  const Matrix3& R = request->X_W.rotation;
  const bool rigid = (R.transpose() * R - Matrix3::Identity()).norm() < 1e-9;
  if (!rigid || !(request->X_W.translation.cwiseAbs().maxCoeff() <= 1.0)) __builtin_trap();
  for (const auto& side :
       {request->measured.length, request->measured.breadth, request->measured.depth}) {
    if (side && !(*side > 0.0 && *side < 1.0)) __builtin_trap();
  }
  if (request->table_height && !(std::abs(*request->table_height) < 10.0)) __builtin_trap();
  return 0;
}
