// What softfinger bears: fingers driven as no hand could (exploration.hpp), and the live loop at
// its pace while everything around it fails (live_soak.hpp), and fingers among objects that they
// throw and squeeze (rough_play.hpp). Status 1 where one of these is not sound.
//
//   softfinger_soak [--steps N] [--seed N] [--live-s S] [--only exploration|play|live]
#include <fmt/core.h>

#include <charconv>
#include <exception>
#include <span>
#include <string_view>

#include "exploration.hpp"
#include "live_soak.hpp"
#include "rough_play.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

struct SoakOptions {
  long steps = 100'000;
  long seed = 1;
  long live_s = 10;  ///< for each fault
  bool explore = true;
  bool play = true;
  bool live = true;
};

/// Shorter runs leave no time for what a fault brings about.
constexpr long kLeastLive_s = 8;

long whole_number(std::string_view flag, std::string_view text, long least = 1) {
  long value = 0;
  const char* end = text.data() + text.size();
  if (const auto read = std::from_chars(text.data(), end, value);
      read.ec != std::errc{} || read.ptr != end || value < least) {
    throw InputError(fmt::format("{}: needs a whole number of at least {}", flag, least));
  }
  return value;
}

SoakOptions options_of(std::span<char*> arguments) {
  SoakOptions options;
  for (std::size_t i = 0; i < arguments.size(); i += 2) {
    const std::string_view flag = arguments[i];
    const std::string_view value = i + 1 < arguments.size() ? arguments[i + 1] : "";
    if (flag == "--steps") {
      options.steps = whole_number(flag, value);
    } else if (flag == "--seed") {
      options.seed = whole_number(flag, value);
    } else if (flag == "--live-s") {
      options.live_s = whole_number(flag, value, kLeastLive_s);
    } else if (flag == "--only" && (value == "exploration" || value == "play" || value == "live")) {
      options.explore = value == "exploration";
      options.play = value == "play";
      options.live = value == "live";
    } else {
      throw InputError(
          fmt::format("unknown option {} {} (there are --steps N, --seed N, --live-s S and --only "
                      "exploration|play|live)",
                      flag, value));
    }
  }
  return options;
}

int soak(std::span<char*> arguments) {
  const SoakOptions options = options_of(arguments);
  bool sound = true;
  if (options.explore) {
    sound = explore_violently(options.steps, static_cast<std::uint64_t>(options.seed)) && sound;
  }
  if (options.play) {
    sound = play_roughly(options.steps, static_cast<std::uint64_t>(options.seed)) && sound;
  }
  if (options.live) sound = soak_live(static_cast<double>(options.live_s)) && sound;
  fmt::print("{}\n", sound ? "sound" : "NOT SOUND");
  return sound ? 0 : 1;
}

}  // namespace
}  // namespace softfinger

int main(int argc, char** argv) {
  try {
    return softfinger::soak(std::span(argv, static_cast<std::size_t>(argc)).subspan(1));
  } catch (const softfinger::InputError& error) {
    fmt::print(stderr, "softfinger_soak: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "softfinger_soak: {}\n", error.what());
    return 1;
  }
}
