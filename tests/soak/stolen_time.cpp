#include "stolen_time.hpp"

#include <fstream>
#include <string>

namespace softfinger {

// proc(5): "cpu", then times in user, nice, system, idle, iowait, irq, softirq, steal, ...; guests'
// times are part of user's.
std::optional<StolenTime::Ticks> StolenTime::now() {
  constexpr int kSteal = 7;
  std::ifstream file("/proc/stat");
  std::string name;
  if (!(file >> name) || name != "cpu") return std::nullopt;
  Ticks ticks;
  double time = 0.0;
  for (int i = 0; i <= kSteal; ++i) {
    if (!(file >> time)) return std::nullopt;
    ticks.all += time;
  }
  ticks.stolen = time;
  return ticks;
}

StolenTime::StolenTime() : began_(now()) {}

std::optional<double> StolenTime::share() const {
  const auto ticks = now();
  if (!began_ || !ticks || !(ticks->all > began_->all)) return std::nullopt;
  return (ticks->stolen - began_->stolen) / (ticks->all - began_->all);
}

}  // namespace softfinger
