#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "softfinger/study/run_study.hpp"
#include "softfinger/study/study_table.hpp"

namespace softfinger {

/// What a page shows of a study while it runs. Every function may be called on any thread.
class StudyPage {
 public:
  /// The designs of the table are those that add() brings: some 300 bytes each stay in memory.
  explicit StudyPage(StudyHeadings headings);

  void at(const StudyProgress& progress);
  void add(const StudyRow& design);
  /// How it ended, in words. Waits until pages that looked on in the last seconds have been told,
  /// three seconds at most.
  void end(std::string state);

  /// "/progress.json": title, kind, state ("running", or how it ended), evaluations, done,
  /// known_before, designs, not_feasible, running_s, evaluations_per_s, left_s (null: not known),
  /// best (a name, value and design an objective), report (a number that changes with it).
  /// "/report.html": report_so_far(), made anew once a second at most. Else empty.
  [[nodiscard]] std::optional<std::string> file(std::string_view path);

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::string progress_json();
  [[nodiscard]] std::string report();
  /// Whether there is something new to draw, and the last drawing is long enough ago.
  [[nodiscard]] bool may_draw() const;

  std::mutex mutex_;
  std::condition_variable told_;
  StudyTable table_;
  StudyProgress progress_;
  std::string state_ = "running";
  Clock::time_point begun_ = Clock::now();
  std::optional<Clock::time_point> looked_;  ///< somebody did
  bool told_end_ = false;
  // The report as drawn last.
  std::string report_;
  std::size_t drawn_ = 0;  ///< designs in it
  Clock::time_point next_drawing_ = begun_;
};

}  // namespace softfinger
