#include "live_soak.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "live_run.hpp"
#include "softfinger/base/units.hpp"
#include "step_times.hpp"

namespace softfinger {
namespace {

constexpr double kPeriod = 1e-3;         // s
constexpr double kRateTolerance = 1e-3;  // of 1000 Hz
/// A loop that is silent for so long lets its devices retract.
constexpr double kLatest = 0.1;  // s
/// A virtual machine that was kept from its processors for more than this share of a run shows
/// little: such a run is repeated, and the least disturbed one counts.
constexpr double kMostStolen = 5e-3;
constexpr int kMostAttempts = 5;
/// Servos follow a command of each 33 ms with the lag of a servo.
constexpr double kMostBehind = 10.0 * deg;
constexpr double kMostUnretracted = 0.5 * deg;
/// What docs/safety.md promises of those that are left when a servo is lost.
constexpr double kLongestRetraction = 4.0;  // s
/// A line that held back a second holds some twenty commands.
constexpr std::size_t kLeastHeldBack = 200;  // bytes
/// It brings no more of those that differ than may be sent to servos that do not answer: 0.1 s and
/// a tick of 33 ms, with what waits as the holding begins and ends.
constexpr int kMostReplayed = 6;

/// Share of steps that were not made in time.
double lost_rate(const LiveOutcome& outcome) { return std::max(0.0, 1.0 - outcome.rate * kPeriod); }
double late(const LiveOutcome& outcome) { return quantile(outcome.lateness, 0.99); }

bool holds_pace(const LiveOutcome& outcome) {
  return lost_rate(outcome) <= kRateTolerance && late(outcome) < kPeriod &&
         quantile(outcome.lateness, 1.0) < kLatest;
}
bool holds_pace_beside(const LiveOutcome& outcome, const LiveOutcome& undisturbed) {
  if (holds_pace(outcome)) return true;
  return !holds_pace(undisturbed) && late(outcome) <= 2.0 * std::max(kPeriod, late(undisturbed)) &&
         lost_rate(outcome) <= 2.0 * std::max(kRateTolerance, lost_rate(undisturbed));
}
/// Whether what came late may be the doing of the machine's host.
bool is_disturbed(const LiveOutcome& outcome) { return outcome.stolen.value_or(0.0) > kMostStolen; }
bool is_where_it_should_be(const LiveOutcome& outcome) {
  const bool followed = outcome.behind.value_or(0.0) <= kMostBehind || is_disturbed(outcome);
  return followed && outcome.unretracted <= kMostUnretracted &&
         outcome.retracted_in <= kLongestRetraction;
}
bool is_told(const LiveFault& fault, const LiveOutcome& outcome) {
  const auto lines = std::ranges::count_if(outcome.messages, [&](const std::string& line) {
    return line.find(fault.told) != std::string::npos;
  });
  return fault.told.empty() || lines >= fault.times_told;
}
/// Whether the fault came about at all, and in what it had to.
bool is_shown(const LiveFault& fault, const LiveOutcome& outcome) {
  if (fault.stops && outcome.retracted_in <= 0.0) return false;
  if (outcome.retracted_in < fault.away_at_end) return false;
  return !fault.holds_back || (outcome.held_back >= kLeastHeldBack && outcome.replayed > 1);
}

void print(const LiveFault& fault, const LiveOutcome& outcome) {
  fmt::print("{}\n", fault.name);
  fmt::print("  {} steps, {:.2f} a second; {} recorded, {} missing", outcome.steps, outcome.rate,
             outcome.recorded, outcome.missing);
  fmt::print("{}\n", outcome.deadline_misses
                         ? fmt::format("; {} deadlines missed", *outcome.deadline_misses)
                         : std::string());
  if (outcome.stolen.value_or(0.0) > 0.0) {
    fmt::print("  this machine's host kept {:.1f} % of its processors' time\n",
               1e2 * *outcome.stolen);
  }
  fmt::print("  a step takes  {}\n", quantiles_ms(outcome.step_time));
  fmt::print("  steps late by {}\n", quantiles_ms(outcome.lateness));
  fmt::print("{}", histogram_ms(outcome.lateness, "    "));
  if (outcome.behind) {
    fmt::print("  servos within {:.2f} deg of their commands (90 % of the last second);",
               *outcome.behind / deg);
  } else {
    fmt::print("  commands of the last second not recorded;");
  }
  fmt::print(" retracted to within {:.2f} deg, {:.2f} s after the {}\n", outcome.unretracted / deg,
             outcome.retracted_in, fault.stops ? "fault" : "end");
  if (fault.holds_back) {
    fmt::print("  {} bytes were held back, with {} different targets of a servo\n",
               outcome.held_back, outcome.replayed);
  }
  fmt::print("  a page that watches got {} pictures, {:.0f} ms apart at most", outcome.pictures,
             1e3 * outcome.longest_gap);
  fmt::print("{}\n", outcome.visitors > 0 ? fmt::format(", beside {} visits", outcome.visitors)
                                          : std::string());
  for (std::size_t i = 0; i < outcome.messages.size() && i < 3; ++i) {
    fmt::print("  told: {}\n", outcome.messages[i]);
  }
  std::fflush(stdout);
}

/// Says what is wrong; true where nothing is.
bool judge(const LiveFault& fault, const LiveOutcome& outcome, const LiveOutcome& undisturbed) {
  const bool holds = holds_pace_beside(outcome, undisturbed);
  const bool paced = holds || is_disturbed(outcome);
  const bool in_place = is_where_it_should_be(outcome);
  if (!holds && paced) fmt::print("  pace not judged: the host kept too much\n");
  if (!paced) fmt::print("  DOES NOT HOLD ITS PACE\n");
  if (outcome.missing > 0) fmt::print("  STEPS ARE MISSING FROM THE RECORDING\n");
  if (!in_place) fmt::print("  THE DEVICE IS NOT WHERE IT SHOULD BE\n");
  const bool told = is_told(fault, outcome);
  const bool shown = is_shown(fault, outcome);
  const bool replayed = fault.holds_back && outcome.replayed > kMostReplayed;
  if (!told) fmt::print("  NOBODY WAS TOLD: {}\n", fault.told);
  if (!shown) fmt::print("  THE FAULT DID NOT COME ABOUT\n");
  if (replayed) fmt::print("  THE PAST WAS REPLAYED\n");
  return paced && in_place && outcome.missing == 0 && told && shown && !replayed;
}

/// For docs/robustness.md.
void print_table_head() {
  fmt::print(
      "\n| fault | steps a second | late, median | 99 % | 99.9 % | most | kept by the host |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n");
}
void print_table_row(const LiveFault& fault, const LiveOutcome& outcome) {
  const auto late_ms = [&](double share) { return 1e3 * quantile(outcome.lateness, share); };
  fmt::print("| {} | {:.1f} | {:.2f} | {:.2f} | {:.1f} | {:.1f} | {} |\n", fault.name, outcome.rate,
             late_ms(0.5), late_ms(0.99), late_ms(0.999), late_ms(1.0),
             outcome.stolen ? fmt::format("{:.1f} %", 1e2 * *outcome.stolen) : "");
}

LiveOutcome least_disturbed(const LiveFault& fault, double seconds) {
  LiveOutcome least = run_live(fault, seconds);
  for (int i = 1; i < kMostAttempts && is_disturbed(least); ++i) {
    LiveOutcome another = run_live(fault, seconds);
    if (another.stolen < least.stolen) least = std::move(another);
  }
  return least;
}

}  // namespace

bool soak_live(double seconds) {
  fmt::print("the live loop at 1 kHz, {:g} s each; steps late after the most punctual one\n",
             seconds);
  bool sound = true;
  int unshown = 0;
  const std::vector<LiveFault> faults = live_faults(seconds);
  std::vector<LiveOutcome> outcomes;
  for (const LiveFault& fault : faults) {
    outcomes.push_back(least_disturbed(fault, seconds));
    const LiveOutcome& outcome = outcomes.back();
    print(fault, outcome);
    sound = judge(fault, outcome, outcomes.front()) && sound;
    if (!holds_pace(outcome) && is_disturbed(outcome)) ++unshown;
  }
  print_table_head();
  for (std::size_t i = 0; i < faults.size(); ++i) print_table_row(faults[i], outcomes[i]);
  fmt::print("\n");
  if (unshown > 0) {
    fmt::print("pace not shown in {} of {} runs: this machine's host was too busy\n", unshown,
               outcomes.size());
  } else if (!holds_pace(outcomes.front())) {
    fmt::print("this machine is too busy: even without a fault the loop does not hold 1 kHz\n");
  }
  return sound;
}

}  // namespace softfinger
