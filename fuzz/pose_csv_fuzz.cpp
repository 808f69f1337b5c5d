#include <cmath>

#include "scratch_file.hpp"
#include "softfinger/tracking/csv_tracker.hpp"

extern "C" int fuzz_pose_csv(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  static const ScratchFile file("poses.csv");
  file.write({data, size});
  read_or_refuse([] {
    CsvTracker tracker(read_pose_csv(file.path()));
    // What was accepted gives finite poses at all times.
    const double end = *tracker.end_time();
    for (const double time : {-1.0, 0.0, 0.3 * end, end, end + 1.0}) {
      if (!tracker.sample(time).X_WFt.rotation.allFinite()) __builtin_trap();
    }
  });
  return 0;
}
