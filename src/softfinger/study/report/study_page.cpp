#include "softfinger/study/report/study_page.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "softfinger/study/report/front.hpp"
#include "softfinger/study/report/study_report.hpp"

namespace softfinger {
namespace {

constexpr std::chrono::seconds kLooksOn{5};  // who asked so recently
constexpr std::chrono::seconds kWaitsForPages{3};
constexpr std::chrono::seconds kBetweenDrawings{1};
constexpr int kShareOfDrawing = 20;  // drawing takes no more than 1 of so many seconds

double seconds_of(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

/// Of each objective the best number of a feasible design, and whose it is.
nlohmann::json best_of(const StudyTable& table) {
  nlohmann::json best = nlohmann::json::array();
  for (std::size_t k = 0; k < objective_count(table.headings); ++k) {
    const auto& quantity = table.headings.quantities[k];
    const StudyRow* found = nullptr;
    for (const StudyRow& row : table.rows) {
      if (!row.feasible()) continue;
      const double value = row.quantities[k];
      if (found == nullptr ||
          (quantity.maximise ? value > found->quantities[k] : value < found->quantities[k])) {
        found = &row;
      }
    }
    if (found == nullptr) continue;
    best.push_back(
        {{"objective", quantity.name}, {"value", found->quantities[k]}, {"design", found->number}});
  }
  return best;
}

}  // namespace

StudyPage::StudyPage(StudyHeadings headings) { table_.headings = std::move(headings); }

void StudyPage::at(const StudyProgress& progress) {
  const std::scoped_lock lock(mutex_);
  progress_ = progress;
}

void StudyPage::add(const StudyRow& design) {
  const std::scoped_lock lock(mutex_);
  table_.rows.push_back(design);
}

void StudyPage::end(std::string state) {
  std::unique_lock lock(mutex_);
  state_ = std::move(state);
  next_drawing_ = Clock::now();
  if (!looked_ || Clock::now() - *looked_ > kLooksOn) return;
  told_.wait_for(lock, kWaitsForPages, [this] { return told_end_; });
}

std::optional<std::string> StudyPage::file(std::string_view path) {
  if (path == "/progress.json") return progress_json();
  if (path == "/report.html") return report();
  return std::nullopt;
}

bool StudyPage::may_draw() const {
  return table_.rows.size() != drawn_ && Clock::now() >= next_drawing_;
}

std::string StudyPage::progress_json() {
  const std::scoped_lock lock(mutex_);
  looked_ = Clock::now();
  const double running = seconds_of(*looked_ - begun_);
  const double rate =
      running > 0.0 ? static_cast<double>(progress_.done - progress_.recorded) / running : 0.0;
  nlohmann::json left;  // null
  if (rate > 0.0) left = static_cast<double>(progress_.cases - progress_.done) / rate;
  const std::size_t report = may_draw() ? table_.rows.size() : drawn_;
  if (state_ != "running" && report == drawn_) {
    told_end_ = true;
    told_.notify_all();
  }
  return nlohmann::json{{"title", table_.headings.title},
                        {"kind", table_.headings.kind},
                        {"state", state_},
                        {"evaluations", progress_.cases},
                        {"done", progress_.done},
                        {"known_before", progress_.recorded},
                        {"designs", progress_.designs},
                        {"not_feasible", progress_.infeasible},
                        {"running_s", running},
                        {"evaluations_per_s", rate},
                        {"left_s", left},
                        {"best", best_of(table_)},
                        {"report", report}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string StudyPage::report() {
  StudyTable table;
  {
    const std::scoped_lock lock(mutex_);
    if (!may_draw()) return report_;
    table = table_;
  }
  const Clock::time_point begin = Clock::now();
  // In the order of the design, as the table is in the end.
  std::ranges::sort(table.rows, {}, &StudyRow::number);
  std::string drawn = report_so_far(table);
  const std::scoped_lock lock(mutex_);
  report_ = std::move(drawn);
  drawn_ = table.rows.size();
  next_drawing_ = Clock::now() + std::max<Clock::duration>(
                                     kBetweenDrawings, kShareOfDrawing * (Clock::now() - begin));
  return report_;
}

}  // namespace softfinger
