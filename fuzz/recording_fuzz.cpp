#include <fstream>
#include <iterator>
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
  std::ifstream in(file.path(), std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

// Input: the bytes of damage done to a sound recording, five each: where (4), what (1). A file of
// noise alone would never get past SQLite's first page.
extern "C" int read_recording(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::uint8_t> sound = sound_recording();
  static const ScratchFile file("damaged.sqlite");
  std::vector<std::uint8_t> damaged = sound;
  for (; size >= 5; data += 5, size -= 5) {
    const std::size_t where = data[0] | std::size_t{data[1]} << 8 | std::size_t{data[2]} << 16;
    if (data[3] == 0xFF) {
      damaged.resize(where % (sound.size() + 1));
    } else if (!damaged.empty()) {
      damaged[where % damaged.size()] = data[4];
    }
  }
  file.write(damaged);
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
