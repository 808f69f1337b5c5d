#include "softfinger/wire/osc.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace softfinger {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Message {
  std::string address;
  std::vector<double> numbers;
  OscNumber type = OscNumber::kFloat32;

  bool operator==(const Message&) const = default;
};

Bytes bundle_of(const std::vector<Message>& messages) {
  std::size_t size = kOscBundleStart;
  for (const Message& message : messages) {
    size +=
        kOscElementStart + osc_message_size(message.address, message.numbers.size(), message.type);
  }
  Bytes bytes(size, 0xEE);  // what stood there is written over
  OscWriter writer(bytes);
  writer.bundle();
  for (const Message& message : messages) {
    writer.message(message.address, message.numbers, message.type);
  }
  EXPECT_EQ(writer.size(), size);
  return bytes;
}

/// False where the packet breaks the format; only messages of numbers.
bool read(const Bytes& packet, std::vector<Message>& messages) {
  messages.clear();
  return read_osc(packet, [&](const OscMessage& message) {
    std::vector<double> numbers(message.types.size());
    const bool are_numbers = message.read(numbers);
    if (are_numbers) {
      messages.push_back({std::string(message.address), numbers,
                          message.types[0] == 'f' ? OscNumber::kFloat32 : OscNumber::kFloat64});
    }
    return are_numbers;
  });
}

// "The Open Sound Control 1.0 Specification": strings padded with one to four zeros, big endian,
// the time tag "immediately".
TEST(Osc, SaysTheBytesOfTheSpecification) {
  EXPECT_EQ(bundle_of({{"/a", {1.0}}}),
            (Bytes{'#', 'b', 'u', 'n', 'd', 'l', 'e', 0, 0,   0,   0, 0, 0,    0,    0, 1,
                   0,   0,   0,   12,  '/', 'a', 0,   0, ',', 'f', 0, 0, 0x3F, 0x80, 0, 0}));
  // An address of four letters gets four zeros, and so do the types of three numbers.
  EXPECT_EQ(osc_message_size("/abc", 3, OscNumber::kFloat32), 8u + 8 + 12);
  EXPECT_EQ(osc_message_size("/abc", 3, OscNumber::kFloat64), 8u + 8 + 24);
  EXPECT_EQ(bundle_of({}).size(), 16u);
}

TEST(Osc, ReadsWhatItWrites) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1e6, 1e6);
  for (int i = 0; i < 500; ++i) {
    std::vector<Message> messages(random() % 8);
    for (Message& message : messages) {
      message.address = "/" + std::string(random() % 20, static_cast<char>('a' + random() % 26));
      message.type = random() % 2 == 0 ? OscNumber::kFloat32 : OscNumber::kFloat64;
      message.numbers.resize(1 + random() % 9);
      for (double& number : message.numbers) {
        number = uniform(random);
        if (message.type == OscNumber::kFloat32) number = static_cast<float>(number);
      }
    }
    std::vector<Message> again;
    ASSERT_TRUE(read(bundle_of(messages), again));
    EXPECT_EQ(again, messages);
  }
}

TEST(Osc, RefusesWhatIsCutOrLies) {
  const Bytes good = bundle_of({{"/joint/1", {1.0}}, {"/joint/2", {2.0}}});
  std::vector<Message> messages;
  for (std::size_t size = 0; size < good.size(); ++size) {
    // Only a cut between two messages leaves a bundle.
    const bool whole = size == 16 || size == 16 + 4 + 12 + 4 + 4;
    EXPECT_EQ(read(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)), messages),
              whole)
        << size;
  }
  for (const auto& [at, byte] : std::vector<std::pair<std::size_t, int>>{
           {0, '/'}, {16, 0xFF}, {19, 8}, {20, 'j'}, {30, 1}, {32, 'f'}, {33, 'i'}, {35, 1}}) {
    Bytes bad = good;
    bad[at] = static_cast<std::uint8_t>(byte);
    EXPECT_FALSE(read(bad, messages)) << at;
  }
}

TEST(Osc, NumbersAreAsManyAsAskedForAndOfOneType) {
  const Bytes packet = bundle_of({{"/three", {1.0, 2.0, 3.0}, OscNumber::kFloat64}});
  int seen = 0;
  EXPECT_TRUE(read_osc(packet, [&](const OscMessage& message) {
    ++seen;
    std::vector<double> numbers(4);
    EXPECT_FALSE(message.read(numbers));
    numbers.resize(2);
    EXPECT_FALSE(message.read(numbers));
    numbers.resize(0);
    EXPECT_FALSE(message.read(numbers));
    numbers.resize(3);
    EXPECT_TRUE(message.read(numbers));
    EXPECT_EQ(numbers, (std::vector{1.0, 2.0, 3.0}));
    return true;
  }));
  EXPECT_EQ(seen, 1);
  // Who says no ends the reading.
  EXPECT_FALSE(read_osc(packet, [](const OscMessage&) { return false; }));
}

}  // namespace
}  // namespace softfinger
