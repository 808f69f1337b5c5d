#include "softfinger/study/study.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/c_interface/answers.hpp"
#include "softfinger/c_interface/host_watch.hpp"
#include "softfinger/c_interface/table.hpp"
#include "softfinger/c_interface/table_collector.hpp"
#include "softfinger/files/shipped_file.hpp"
#include "softfinger/study/contacts/contact_file.hpp"
#include "softfinger/study/contacts/run_contacts.hpp"
#include "softfinger/study/report/study_report.hpp"
#include "softfinger/study/run_study.hpp"
#include "softfinger/study/study_table.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

StudyOptions study_options(const char* folder, const sf_study_options& given) {
  StudyOptions options{.out = folder};
  if (given.shard == 0 && given.shards == 0) return options;
  if (given.shard < 1 || given.shard > given.shards || given.shards > 1000000) {
    throw InputError("shard: must be from 1 to shards");
  }
  options.shard = Shard{.number = given.shard, .count = given.shards};
  return options;
}

std::unique_ptr<Table> studied(const char* study, const char* folder,
                               const sf_study_options& given) {
  const HostWatch host(given.stop, given.progress);
  const StudyOptions options = study_options(folder, given);
  const std::filesystem::path file = file_or_shipped(Shipped::kStudy, study);
  std::vector<std::string> messages;
  StudyObserver observer;
  observer.message = [&](const std::string& message) { messages.push_back(message); };
  observer.progress = [&](const StudyProgress& at) {
    if (at.cases == 0 || given.progress == nullptr) return;
    *given.progress = static_cast<double>(at.done) / static_cast<double>(at.cases);
  };
  OneRank alone;
  const StudySummary summary =
      is_contact_study(file)
          ? run_contacts(load_contact_study(file), options, alone, host.stop(), observer)
          : run_study(load_study(file), options, alone, host.stop(), observer);
  const StudyProgress& at = summary.progress;
  if (summary.end == StudyEnd::kStopped) {
    throw OperationError(
        fmt::format("study: stopped; {} of {} evaluations are recorded, and the same call goes on "
                    "from there",
                    at.done, at.cases));
  }
  auto table = std::make_unique<Table>();
  table->text = Json{
      {"end", name_of(summary.end)},
      {"designs", at.designs},
      {"infeasible", at.infeasible},
      {"cases", at.cases},
      {"done", at.done},
      {"recorded", at.recorded},
      {"first_reason", summary.first_reason},
      {"messages",
       messages}}.dump(2);
  return table;
}

std::unique_ptr<Table> table_of(const StudyTable& study) {
  auto table = std::make_unique<Table>();
  TableCollector rows(*table, study_columns(study));
  write_study(study, rows);
  const StudyHeadings& headings = study.headings;
  Json parameters = Json::array(), objectives = Json::array(), constraints = Json::array();
  for (const auto& parameter : headings.parameters) parameters.push_back(parameter.key);
  for (const auto& quantity : headings.quantities) {
    Json told{{"name", quantity.name}, {"what", quantity.what}};
    if (quantity.objective) told["maximise"] = quantity.maximise;
    (quantity.objective ? objectives : constraints).push_back(std::move(told));
  }
  table->text =
      Json{{"study", headings.title},   {"kind", headings.kind},    {"device", headings.device},
           {"parameters", parameters},  {"objectives", objectives}, {"constraints", constraints},
           {"finished", study.finished}}
          .dump(2);
  return table;
}

std::string exported(const char* folder, const char* to) {
  if (std::filesystem::exists(std::filesystem::path(folder) / kContactFileName)) {
    const ContactsDone presses = export_contacts(folder, to);
    if (presses.done == presses.all) return {};
    return fmt::format("the study is not finished; {} of {} presses so far", presses.done,
                       presses.all);
  }
  const StudyTable table = read_study_table(folder);
  export_study(table, to);
  if (table.finished) return {};
  return fmt::format("the study is not finished; {} designs so far", table.rows.size());
}

}  // namespace
}  // namespace softfinger

sf_status sf_study_run(const char* study, const char* folder, const sf_study_options* options,
                       sf_table** out, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (study == nullptr || folder == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "study, folder and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    *out = new sf_table(softfinger::studied(
        study, folder, softfinger::taken(options, sizeof(sf_study_options), "sf_study_options")));
    return SF_DONE;
  });
}

sf_status sf_study_table(const char* folder, sf_table** out, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (folder == nullptr || out == nullptr) {
    return text.tell(SF_BAD_INPUT, "folder and out must not be NULL");
  }
  *out = nullptr;
  return softfinger::guarded(text, [&] {
    *out = new sf_table(softfinger::table_of(softfinger::read_study_table(folder)));
    return SF_DONE;
  });
}

sf_status sf_study_export(const char* folder, const char* to, char* note, size_t capacity,
                          char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (folder == nullptr || to == nullptr) {
    return text.tell(SF_BAD_INPUT, "folder and to must not be NULL");
  }
  return softfinger::guarded(text, [&] {
    softfinger::copy_text(softfinger::exported(folder, to), note, capacity, nullptr);
    return SF_DONE;
  });
}

sf_status sf_study_device(const char* folder, int64_t design, const char* to, char* error,
                          size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (folder == nullptr || to == nullptr) {
    return text.tell(SF_BAD_INPUT, "folder and to must not be NULL");
  }
  return softfinger::guarded(text, [&] {
    softfinger::export_device(softfinger::read_study_table(folder), design, to);
    return SF_DONE;
  });
}

sf_status sf_study_plot(const char* folder, const char* to, char* error, size_t error_size) {
  const softfinger::ErrorText text{error, error_size};
  if (folder == nullptr || to == nullptr) {
    return text.tell(SF_BAD_INPUT, "folder and to must not be NULL");
  }
  return softfinger::guarded(text, [&] {
    softfinger::write_study_report(softfinger::read_study_table(folder), to);
    return SF_DONE;
  });
}
