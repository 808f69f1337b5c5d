#include "softfinger/study/contacts/run_contacts.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <regex>
#include <system_error>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/files/whole_file.hpp"
#include "softfinger/study/contacts/contact_file.hpp"
#include "softfinger/study/contacts/contact_press.hpp"
#include "softfinger/study/journal_lock.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

// The first letter of a result, and of what rank 0 says.
constexpr char kPressed = 'p';
constexpr char kFailed = 'f';

std::string pressed(ContactPress& press, std::size_t number) {
  try {
    return kPressed + press.press(number).bytes();
  } catch (const std::exception& error) {
    return kFailed + std::string(error.what());
  }
}

std::vector<fs::path> contact_shards(const fs::path& folder) {
  static const std::regex kName("contacts-[0-9]+-of-[0-9]+\\.h5");
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (std::regex_match(entry.path().filename().string(), kName)) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// Rank 0's side.
class ContactLeader {
 public:
  ContactLeader(const ContactStudy& study, const StudyOptions& options, ContactPress& press,
                const std::vector<StudyFact>& facts)
      : study_(study), shard_(options.shard), press_(press), facts_(facts), folder_(options.out) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (!fs::is_directory(folder_, error)) {
      throw InputError(fmt::format("{}: cannot be made a folder", folder_.string()));
    }
    const fs::path file =
        folder_ / (shard_ ? fmt::format("contacts-{}-of-{}.h5", shard_->number, shard_->count)
                          : kContactFileName);
    lock_.emplace(file);
    file_.emplace(file, study, press, facts);
  }

  StudySummary run(Ranks& ranks, const std::atomic<bool>& stop, const StudyObserver& observer) {
    if (!shard_) take_shards();
    std::vector<std::uint64_t> open;
    for (std::size_t number = 0; number < study_.presses(); ++number) {
      if (file_->has(number) || (shard_ && !shard_->has(number))) continue;
      open.push_back(number);
    }
    StudyProgress progress{.cases = study_.presses()};
    progress.done = progress.recorded = file_->done();
    if (observer.progress) observer.progress(progress);
    std::string message;
    message.resize(open.size() * sizeof(open[0]));
    std::copy_n(reinterpret_cast<const char*>(open.data()), message.size(), message.begin());
    ranks.broadcast(kPressed + message);
    ranks.share(
        open.size(), [&](std::size_t task) { return pressed(press_, open[task]); },
        [&](std::size_t task, std::string_view result) {
          if (!result.starts_with(kPressed)) throw OperationError(std::string(result.substr(1)));
          file_->write(open[task], PressedContacts::of_bytes(result.substr(1)));
          ++progress.done;
          if (observer.progress) observer.progress(progress);
        },
        stop);
    StudySummary summary;
    progress.designs = study_.size;
    summary.progress = progress;
    const bool whole = std::ranges::all_of(open, [&](std::uint64_t n) { return file_->has(n); });
    if (!whole) {
      summary.end = StudyEnd::kStopped;
    } else if (shard_) {
      summary.end = StudyEnd::kShardDone;
    }
    file_->close();
    return summary;
  }

 private:
  void take_shards() {
    for (const fs::path& path : contact_shards(folder_)) {
      {
        const JournalLock lock(path);
        ContactFile shard(path, study_, press_, facts_);
        for (std::size_t number = 0; number < study_.presses(); ++number) {
          if (shard.has(number) && !file_->has(number)) file_->write(number, shard.read(number));
        }
        shard.close();
      }
      std::error_code error;
      fs::remove(path, error);
      fs::remove(JournalLock::file_of(path), error);
    }
  }

  const ContactStudy& study_;
  std::optional<Shard> shard_;
  ContactPress& press_;
  const std::vector<StudyFact>& facts_;
  fs::path folder_;
  std::optional<JournalLock> lock_;
  std::optional<ContactFile> file_;
};

}  // namespace

StudyHeadings headings_of(const ContactStudy& study) {
  return {.title = study.file.stem().string(), .kind = "contacts"};
}

StudySummary run_contacts(const ContactStudy& study, const StudyOptions& options, Ranks& ranks,
                          const std::atomic<bool>& stop, const StudyObserver& observer) {
  ContactPress press(study);
  const std::vector<StudyFact> facts = contact_facts(study);
  const std::string same = std::to_string(hash_of(facts));
  if (ranks.rank() > 0) {
    const bool is_alike = ranks.broadcast({}) == same;
    const std::string message = ranks.broadcast({});
    if (!message.starts_with(kPressed)) return {};
    std::vector<std::uint64_t> open((message.size() - 1) / sizeof(std::uint64_t));
    std::copy_n(message.begin() + 1, open.size() * sizeof(open[0]),
                reinterpret_cast<char*>(open.data()));
    ranks.share(
        open.size(),
        [&](std::size_t task) {
          return is_alike ? pressed(press, open[task])
                          : kFailed + fmt::format(
                                          "rank {} has other files, another build or another "
                                          "instruction set than rank 0",
                                          ranks.rank());
        },
        {}, stop);
    return {};
  }
  ranks.broadcast(same);
  std::optional<ContactLeader> leader;
  try {
    leader.emplace(study, options, press, facts);
  } catch (...) {
    ranks.broadcast("end");
    throw;
  }
  return leader->run(ranks, stop, observer);
}

ContactsDone export_contacts(const fs::path& folder, const fs::path& to) {
  const fs::path file = folder / kContactFileName;
  std::error_code error;
  if (!fs::exists(file, error)) {
    throw InputError(
        fmt::format("{}: has shards alone; softfinger study without --shard takes them "
                    "together and finishes",
                    folder.string()));
  }
  if (to.extension() != ".h5") {
    throw InputError(
        fmt::format("{}: contacts are exported as HDF5, to a name that ends in .h5", to.string()));
  }
  if (fs::exists(to, error)) {
    throw InputError(fmt::format("{}: exists already", to.string()));
  }
  const ContactsDone done = contacts_done(file);
  std::ifstream from(file, std::ios::binary);
  if (!write_file_whole(to, [&](std::ostream& stream) { stream << from.rdbuf(); })) {
    throw OperationError(
        fmt::format("{}: cannot be written (is there room on the disk?)", to.string()));
  }
  return done;
}

}  // namespace softfinger
