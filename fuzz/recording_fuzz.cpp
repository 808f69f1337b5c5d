#include <vector>

#include "scratch_file.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/recording/recording_writer.hpp"

namespace {

using namespace softfinger;

/// A small complete recording, as bytes.
std::vector<std::uint8_t> sound_recording() {
  const ScratchFile file("sound.sqlite");
  RecordingInfo info;
  info.simulation_rate = 1000.0;
  info.fingers.push_back({.name = "index", .configuration_names = {"pitch_deg"}, .joints = 1});
  RecordingWriter writer(file.path(), info, RecordingWriter::WhenFull::kWait, {});
  for (std::int64_t step = 0; step < 20; ++step) writer.push(StepRecord{.step = step});
  writer.close();
  return file.read();
}

}  // namespace

// Input: damage done to a sound recording, anywhere.
extern "C" int fuzz_recording(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::uint8_t> sound = sound_recording();
  static const ScratchFile file("damaged.sqlite");
  file.write(damaged(sound, {data, size}, sound.size()));
  read_or_refuse([] {
    RecordingReader reader(file.path());
    StepRecord step;
    while (reader.next(step)) {
    }
    TickRecord tick;
    while (reader.next(tick)) {
    }
  });
  return 0;
}
