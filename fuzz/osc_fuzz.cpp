#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "softfinger/wire/osc.hpp"

namespace {

using namespace softfinger;

struct Numbers {
  std::string address;
  std::vector<double> values;
};

/// The messages of a packet that are of numbers.
std::vector<Numbers> messages_of(std::span<const std::uint8_t> packet, bool& whole) {
  std::vector<Numbers> messages;
  whole = read_osc(packet, [&](const OscMessage& message) {
    std::vector<double> values(message.types.size());
    if (message.read(values)) messages.push_back({std::string(message.address), values});
    return true;
  });
  return messages;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

// What is read from a packet is read again from a bundle that is written of it.
extern "C" int fuzz_osc(const std::uint8_t* data, std::size_t size) {
  bool whole = false;
  const std::vector<Numbers> messages = messages_of({data, size}, whole);
  if (!whole) return 0;
  std::size_t room = kOscBundleStart;
  for (const Numbers& message : messages) {
    room += kOscElementStart +
            osc_message_size(message.address, message.values.size(), OscNumber::kFloat64);
  }
  std::vector<std::uint8_t> bytes(room);
  OscWriter writer(bytes);
  writer.bundle();
  for (const Numbers& message : messages) {
    writer.message(message.address, message.values, OscNumber::kFloat64);
  }
  if (writer.size() != room || !is_osc_bundle(bytes)) __builtin_trap();
  const std::vector<Numbers> again = messages_of(bytes, whole);
  if (!whole || again.size() != messages.size()) __builtin_trap();
  for (std::size_t i = 0; i < again.size(); ++i) {
    if (again[i].address != messages[i].address ||
        !std::equal(again[i].values.begin(), again[i].values.end(), messages[i].values.begin(),
                    messages[i].values.end(), same)) {
      __builtin_trap();
    }
  }
  return 0;
}
