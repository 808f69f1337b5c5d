#include <cstring>
#include <vector>

#include "softfinger/motors/osc/osc_bundle.hpp"

// A packet that is a bundle is written again as it was, but for its time tag.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  const auto messages = decode_osc_bundle({data, size});
  if (!messages) return 0;
  std::vector<std::uint8_t> bytes(osc_bundle_size(*messages));
  if (bytes.size() != size || encode_osc_bundle(*messages, bytes) != size) __builtin_trap();
  std::memcpy(bytes.data() + 8, data + 8, 8);
  if (std::memcmp(bytes.data(), data, size) != 0) __builtin_trap();
  return 0;
}
