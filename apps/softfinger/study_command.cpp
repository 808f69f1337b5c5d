#include <fmt/format.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "commands.hpp"
#include "port_option.hpp"
#include "progress_bar.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/study/contacts/contact_file.hpp"
#include "softfinger/study/contacts/run_contacts.hpp"
#include "softfinger/study/report/study_page.hpp"
#include "softfinger/study/report/study_report.hpp"
#include "softfinger/study/run_study.hpp"
#include "softfinger/study/study_table.hpp"
#include "softfinger/viewer/report_server.hpp"
#include "stop_signal.hpp"

namespace {

using namespace softfinger;

struct StudyFlags {
  std::string study, out, shard;
  bool page = false;
  std::uint16_t port = 0;
};

/// The page of a running study, where one is asked for, and its server.
class ServedStudy {
 public:
  ServedStudy(PagePort port, StudyHeadings headings)
      : page_(std::move(headings)),
        server_(std::move(port), [this](std::string_view path) { return page_.file(path); }) {
    fmt::print("softfinger: {}\n", server_.url());
    std::fflush(stdout);
  }
  [[nodiscard]] StudyPage& page() { return page_; }

 private:
  StudyPage page_;
  ReportServer server_;
};

struct StudyTableFlags {
  std::string folder, to;
  std::optional<std::int64_t> design;
};

Shard shard_of(const std::string& text) {
  Shard shard;
  char* end = nullptr;
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos && slash > 0) {
    shard.number = std::strtoull(text.c_str(), &end, 10);
    const bool first = end == text.c_str() + slash;
    shard.count = std::strtoull(text.c_str() + slash + 1, &end, 10);
    const bool digits = text.find_first_not_of("0123456789/") == std::string::npos;
    if (first && digits && *end == '\0' && shard.number >= 1 && shard.number <= shard.count &&
        shard.count <= 1000000) {
      return shard;
    }
  }
  throw InputError(fmt::format("--shard {}: expected I/N, I from 1 to N, as in 3/64", text));
}

std::string summary_text(const StudySummary& summary, const StudyFlags& flags) {
  const StudyProgress& at = summary.progress;
  const std::string counts =
      fmt::format("{} designs, {} not feasible; {} of {} evaluations were known before", at.designs,
                  at.infeasible, at.recorded, at.cases);
  switch (summary.end) {
    case StudyEnd::kFinished:
      return fmt::format("{}\n", counts);
    case StudyEnd::kShardDone:
      return fmt::format(
          "shard {} is done; when all are, softfinger study without --shard takes "
          "them together\n",
          flags.shard);
    case StudyEnd::kAwaitsOthers:
      return fmt::format(
          "shard {} has done its part of this generation; the next one needs the "
          "other shards: run them, then this one again, or finish without --shard\n",
          flags.shard);
    case StudyEnd::kStopped:
      break;
  }
  return {};
}

/// What every rank has to read alike; where one cannot, none goes on, and the first that cannot
/// says why.
template <typename Load>
auto load_on_every_rank(const Load& load, Ranks& ranks) {
  std::optional<decltype(load())> study;
  std::string why;
  try {
    study.emplace(load());
  } catch (const InputError& error) {
    if (ranks.size() == 1) throw;
    why = error.what();
  }
  const bool first_has_it = ranks.broadcast(study ? "read" : "") == "read";
  if (ranks.all(study.has_value())) return std::move(*study);
  if (!study && (ranks.rank() == 0 || first_has_it)) fmt::print(stderr, "softfinger: {}\n", why);
  // Said before any rank leaves: the first that does ends the job.
  ranks.all(false);
  throw CLI::RuntimeError(2);
}

/// Runs it, and tells its page how it ended.
template <typename Run>
StudySummary run_served(const Run& run, ServedStudy* served) {
  try {
    const StudySummary summary = run();
    if (served != nullptr) served->page().end(std::string(name_of(summary.end)));
    return summary;
  } catch (...) {
    if (served != nullptr) served->page().end("failed");
    throw;
  }
}

void run_study_command(const StudyFlags& flags) {
  StudyOptions options{.out = flags.out};
  const std::unique_ptr<Ranks> ranks = ranks_of_this_job();
  // Refused before anything begins; the first rank alone has a page.
  auto port = load_on_every_rank(
      [&]() -> std::unique_ptr<PagePort> {
        if (!flags.page || ranks->rank() > 0) return nullptr;
        return std::make_unique<PagePort>(ServerOptions{.port = flags.port});
      },
      *ranks);
  std::optional<ServedStudy> served;
  if (!flags.shard.empty()) {
    options.shard = load_on_every_rank([&flags] { return shard_of(flags.shard); }, *ranks);
  }
  ProgressBar bar;
  StudyObserver observer;
  observer.message = [&bar](const std::string& message) {
    bar.clear();
    fmt::print(stderr, "softfinger: {}\n", message);
  };
  observer.progress = [&bar, &served](const StudyProgress& at) {
    if (served) served->page().at(at);
    if (at.cases == 0) return;
    bar.show(static_cast<double>(at.done) / static_cast<double>(at.cases),
             fmt::format("{} of {} evaluations, {} designs, {} not feasible", at.done, at.cases,
                         at.designs, at.infeasible));
  };
  observer.design = [&served](const StudyRow& row) {
    if (served) served->page().add(row);
  };
  const bool of_contacts =
      load_on_every_rank([&flags] { return is_contact_study(flags.study); }, *ranks);
  StudySummary summary;
  if (of_contacts) {
    const ContactStudy study =
        load_on_every_rank([&flags] { return load_contact_study(flags.study); }, *ranks);
    if (port) served.emplace(std::move(*port), headings_of(study));
    summary = run_served(
        [&] { return run_contacts(study, options, *ranks, stop_on_signals(), observer); },
        served ? &*served : nullptr);
  } else {
    const Study study = load_on_every_rank([&flags] { return load_study(flags.study); }, *ranks);
    if (port) served.emplace(std::move(*port), headings_of(study));
    summary =
        run_served([&] { return run_study(study, options, *ranks, stop_on_signals(), observer); },
                   served ? &*served : nullptr);
  }
  bar.clear();
  if (ranks->rank() > 0) return;
  if (summary.end == StudyEnd::kStopped) {
    throw OperationError(
        fmt::format("stopped; {} of {} evaluations are recorded, and the same "
                    "command goes on from there",
                    summary.progress.done, summary.progress.cases));
  }
  if (of_contacts && summary.end == StudyEnd::kFinished) {
    fmt::print("{} contacts; {} of {} presses were known before\n", summary.progress.designs,
               summary.progress.recorded, summary.progress.cases);
    return;
  }
  fmt::print("{}", summary_text(summary, flags));
  if (summary.end == StudyEnd::kFinished &&
      summary.progress.infeasible == summary.progress.designs) {
    throw OperationError(
        fmt::format("{}: no design is feasible; the first: {}", flags.study, summary.first_reason));
  }
}

void export_command(const StudyTableFlags& flags) {
  if (std::filesystem::exists(std::filesystem::path(flags.folder) / kContactFileName)) {
    const ContactsDone presses = export_contacts(flags.folder, flags.to);
    fmt::print("contacts in {}\n", flags.to);
    if (presses.done < presses.all) {
      fmt::print(stderr, "softfinger: the study is not finished; {} of {} presses so far\n",
                 presses.done, presses.all);
    }
    return;
  }
  const StudyTable table = read_study_table(flags.folder);
  if (flags.design) {
    export_device(table, *flags.design, flags.to);
    fmt::print("design {} in {}\n", *flags.design, flags.to);
    return;
  }
  export_study(table, flags.to);
  fmt::print("{} designs in {}\n", table.rows.size(), flags.to);
  if (!table.finished) {
    fmt::print(stderr, "softfinger: the study is not finished; {} designs so far\n",
               table.rows.size());
  }
}

}  // namespace

void add_study_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "study", "Many designs, worn by many people: evaluated, recorded, resumed; also by mpirun");
  auto flags = std::make_shared<StudyFlags>();
  command->require_subcommand(0, 1);
  CLI::Option* study = takes_shipped(
      command->add_option("STUDY", flags->study,
                          "study file (TOML): what varies, who wears it, what is better; or the "
                          "name of a shipped one"),
      Shipped::kStudy);
  command->add_option("--out", flags->out,
                      "folder of the study, made if absent; goes on with what is there");
  command->add_option("--shard", flags->shard,
                      "I/N: one of N equal parts, for job arrays; all into one --out");
  CLI::Option* port = add_port_option(
      *command, "--port", flags->port,
      "a page of the running study at this port of this machine alone; 0: any free one");
  port->default_str("");
  CLI::App* exporting =
      command->add_subcommand("export", "A row a design, as CSV; contacts as HDF5");
  auto to = std::make_shared<StudyTableFlags>();
  exporting->add_option("DIR", to->folder, "what study --out made")->required();
  exporting->add_option("--to", to->to, "FILE.csv, or FILE.h5 of contacts; must not be there yet")
      ->required();
  exporting->add_option("--design", to->design,
                        "the device file of this design instead, by its number in the table");
  exporting->callback([to] { export_command(*to); });
  CLI::App* plotting = command->add_subcommand(
      "plot", "Front, effects, indices and best designs, as plots and one page");
  auto page = std::make_shared<StudyTableFlags>();
  plotting->add_option("DIR", page->folder, "what study --out made, or makes")->required();
  plotting->add_option("--to", page->to, "folder for report.html and SVG files, made if absent")
      ->required();
  plotting->callback([page] {
    write_study_report(read_study_table(page->folder), page->to);
    fmt::print("{}\n", (std::filesystem::path(page->to) / "report.html").string());
  });
  command->callback([command, flags, study, port] {
    flags->page = port->count() > 0;
    if (!command->get_subcommands().empty()) return;
    if (study->empty()) throw InputError("study: give a study file (TOML), or export");
    if (flags->out.empty()) throw InputError("study: give --out, the folder of what comes out");
    run_study_command(*flags);
  });
}
