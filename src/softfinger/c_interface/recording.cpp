#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/host_watch.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/c_interface/table_collector.hpp"
#include "softfinger/export/export_recording.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/recording/recording_tables.hpp"
#include "softfinger/session/replay.hpp"
#include "softfinger/session/report/replay_report.hpp"

namespace softfinger {
namespace {

sf_watch watch_of(const sf_watch* given) { return taken(given, sizeof(sf_watch), "sf_watch"); }

std::unique_ptr<Table> recorded(const char* file, const char* name, const HostWatch& host) {
  RecordingReader reader(file);
  reader.watch(host.ending("recording"));
  auto table = std::make_unique<Table>();
  OneTable store(*table, text_or_empty(name));
  write_tables(reader, store);
  std::vector<std::string> names = store.names();
  std::ranges::sort(names);
  if (name != nullptr && !std::ranges::binary_search(names, name)) {
    throw InputError(fmt::format("{}: table {}: there is {}", file, name, fmt::join(names, ", ")));
  }
  table->text =
      nlohmann::ordered_json{{"tables", names}, {"note", reader.how_it_was_cut()}}.dump(2);
  return table;
}

std::unique_ptr<Table> replayed(const char* recording, const sf_replay_options& given) {
  const HostWatch host(given.stop, given.progress);
  ReplayOptions options{.recording = recording, .scene = {}, .load_observer = host.load_observer()};
  if (given.scene != nullptr) options.scene = file_or_shipped(Shipped::kScene, given.scene);
  if (given.person != nullptr) options.person = given.person;
  auto table = std::make_unique<Table>();
  table->text = replay_report(replay(options, host.ending("replay"))).dump(2);
  return table;
}

}  // namespace
}  // namespace softfinger

sf_status sf_recording_export(const char* recording, const char* to, char* note, size_t capacity,
                              char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (recording == nullptr || to == nullptr) {
    return text.tell(SF_BAD_INPUT, "recording and to must not be NULL");
  }
  return softfinger::guarded(text, [&] {
    softfinger::copy_text(softfinger::export_recording(recording, to), note, capacity, nullptr);
    return SF_DONE;
  });
}

sf_status sf_recording_replay(const char* recording, int32_t* agree, char* difference,
                              size_t capacity, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (recording == nullptr || agree == nullptr) {
    return text.tell(SF_BAD_INPUT, "recording and agree must not be NULL");
  }
  return softfinger::guarded(text, [&] {
    const softfinger::ReplayResult result =
        softfinger::replay({.recording = recording, .scene = {}, .load_observer = {}});
    *agree = result.agree ? 1 : 0;
    softfinger::copy_text(result.difference, difference, capacity, nullptr);
    return SF_DONE;
  });
}

sf_status sf_recording_table(const char* recording, const char* table, const sf_watch* watch,
                             sf_table** out, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (recording == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "recording and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    const softfinger::HostWatch host(softfinger::watch_of(watch));
    *out = new sf_table(softfinger::recorded(recording, table, host));
    return SF_DONE;
  });
}

sf_status sf_export(const char* recording, const char* to, const sf_watch* watch, char* note,
                    size_t capacity, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (recording == nullptr || to == nullptr) {
    return text.tell(SF_BAD_INPUT, "recording and to must not be NULL");
  }
  return softfinger::guarded(text, [&] {
    const softfinger::HostWatch host(softfinger::watch_of(watch));
    softfinger::copy_text(softfinger::export_recording(recording, to, host.ending("export")), note,
                          capacity, nullptr);
    return SF_DONE;
  });
}

sf_status sf_replay(const char* recording, const sf_replay_options* options, sf_table** out,
                    char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (recording == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "recording and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    *out = new sf_table(softfinger::replayed(
        recording, softfinger::taken(options, sizeof(sf_replay_options), "sf_replay_options")));
    return SF_DONE;
  });
}
