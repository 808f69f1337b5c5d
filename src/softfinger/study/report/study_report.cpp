#include "softfinger/study/report/study_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/files/whole_file.hpp"
#include "softfinger/study/report/chart.hpp"
#include "softfinger/study/report/front.hpp"
#include "softfinger/study/report/sensitivity.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostDots = 4000;  // of a plot
constexpr std::size_t kMostBest = 25;
constexpr std::size_t kMostReasons = 12;
constexpr std::size_t kMeans = 12;  // along a parameter

std::vector<double> parameter_of(const StudyTable& table, const std::vector<std::size_t>& rows,
                                 std::size_t k) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (const std::size_t row : rows) values.push_back(table.rows[row].parameters[k]);
  return values;
}

std::vector<double> quantity_of(const StudyTable& table, const std::vector<std::size_t>& rows,
                                std::size_t k) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (const std::size_t row : rows) values.push_back(table.rows[row].quantities[k]);
  return values;
}

Chart::Points paired(const std::vector<double>& x, const std::vector<double>& y) {
  Chart::Points points;
  for (std::size_t i = 0; i < x.size(); ++i) points.emplace_back(x[i], y[i]);
  return points;
}

/// Every so many, so that no more than kMostDots are left.
std::vector<std::size_t> thinned(const std::vector<std::size_t>& rows) {
  const std::size_t step = 1 + rows.size() / kMostDots;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < rows.size(); i += step) left.push_back(rows[i]);
  return left;
}

class Report {
 public:
  explicit Report(const StudyTable& table) : table_(table), front_(front_of(table)) {
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      if (table.rows[row].feasible()) feasible_.push_back(row);
    }
    objectives_ = objective_count(table.headings);
  }

  /// Throws OperationError.
  void write(const fs::path& folder) {
    best_found();
    if (!feasible_.empty()) {
      effects();
      indices();
    }
    best();
    reasons();
    for (const auto& [name, svg] : plots_) save(folder / name, svg);
    save(folder / "report.html", page());
  }

  /// What is worth looking at before a study is finished.
  [[nodiscard]] std::string so_far() {
    best_found();
    best();
    reasons();
    return body_;
  }

 private:
  [[nodiscard]] const std::string& objective(std::size_t k) const {
    return table_.headings.quantities[k].name;
  }

  /// A plot of its own, and in the page.
  void add(std::string file, std::string svg) {
    body_ += svg;
    plots_.emplace_back(std::move(file), std::move(svg));
  }
  void heading(const char* title, const char* words) {
    body_ += fmt::format("<h2>{}</h2><p>{}</p>", title, words);
  }
  static void save(const fs::path& file, const std::string& text) {
    if (write_file_whole(file, [&](std::ostream& stream) { stream << text; })) return;
    throw OperationError(
        fmt::format("{}: cannot be written (is there room on the disk?)", file.string()));
  }

  void best_found() {
    if (feasible_.empty()) return;
    if (objectives_ >= 2) {
      fronts();
    } else {
      best_so_far();
    }
  }

  void fronts() {
    heading("Front",
            "Each dot is a design; red ones no other is better than in one objective and "
            "no worse in the rest.");
    const std::vector<std::size_t> shown = thinned(feasible_);
    for (std::size_t a = 0; a < objectives_; ++a) {
      for (std::size_t b = a + 1; b < objectives_; ++b) {
        // Far off ones would press the front into a corner.
        Chart chart(460, 340, near(a), near(b));
        chart.dots(paired(quantity_of(table_, shown, a), quantity_of(table_, shown, b)), "all");
        const auto front = paired(quantity_of(table_, front_, a), quantity_of(table_, front_, b));
        if (objectives_ == 2) chart.line(front, "frontline");
        chart.dots(front, "front");
        add(fmt::format("front-{}-{}.svg", objective(a), objective(b)), chart.svg());
      }
    }
  }

  /// An axis for an objective that shows all of the front and nine in ten of the rest.
  [[nodiscard]] Chart::Axis near(std::size_t k) const {
    std::vector<double> values = quantity_of(table_, feasible_, k);
    std::ranges::sort(values);
    if (table_.headings.quantities[k].maximise) std::ranges::reverse(values);
    values.resize(std::max<std::size_t>(1, values.size() * 9 / 10));
    const std::vector<double> front = quantity_of(table_, front_, k);
    values.insert(values.end(), front.begin(), front.end());
    return Chart::axis(objective(k), values);
  }

  void best_so_far() {
    heading("Best so far", "The objective of each design, in their order, and the best up to it.");
    const bool more = table_.headings.quantities[0].maximise;
    Chart::Points all;
    Chart::Points best;
    for (const std::size_t row : feasible_) {
      const auto number = static_cast<double>(table_.rows[row].number);
      const double value = table_.rows[row].quantities[0];
      all.emplace_back(number, value);
      const double before = best.empty() ? value : best.back().second;
      best.emplace_back(number, more ? std::max(before, value) : std::min(before, value));
    }
    std::vector<double> numbers;
    for (const auto& [number, value] : all) numbers.push_back(number);
    Chart chart(620, 300, Chart::axis("design", numbers), near(0));
    chart.dots(all, "all");
    chart.line(best, "mean");
    add("best.svg", chart.svg());
  }

  void effects() {
    heading("What each parameter does",
            "Each design over one of its parameters; the line is the mean over equal shares of "
            "them.");
    const std::vector<std::size_t> shown = thinned(feasible_);
    for (std::size_t k = 0; k < table_.headings.parameters.size(); ++k) {
      const auto& parameter = table_.headings.parameters[k];
      if (parameter.tied) continue;
      for (std::size_t q = 0; q < objectives_; ++q) {
        const Chart::Axis x =
            Chart::axis(parameter.key, parameter_of(table_, feasible_, k), parameter.log);
        Chart chart(340, 240, x, near(q));
        chart.dots(paired(parameter_of(table_, shown, k), quantity_of(table_, shown, q)), "all");
        chart.line(means_along(k, q), "mean");
        add(fmt::format("effect-{}-{}.svg", parameter.key, objective(q)), chart.svg());
      }
    }
  }

  [[nodiscard]] Chart::Points means_along(std::size_t k, std::size_t q) const {
    std::vector<std::size_t> order = feasible_;
    std::ranges::stable_sort(order, {},
                             [&](std::size_t r) { return table_.rows[r].parameters[k]; });
    Chart::Points means;
    const std::size_t shares = std::min(kMeans, std::max<std::size_t>(1, order.size() / 3));
    for (std::size_t s = 0; s < shares; ++s) {
      double x = 0.0;
      double y = 0.0;
      const std::size_t begin = s * order.size() / shares;
      const std::size_t end = (s + 1) * order.size() / shares;
      for (std::size_t i = begin; i < end; ++i) {
        x += table_.rows[order[i]].parameters[k];
        y += table_.rows[order[i]].quantities[q];
      }
      const auto count = static_cast<double>(end - begin);
      means.emplace_back(x / count, y / count);
    }
    return means;
  }

  void indices() {
    const std::string& kind = table_.headings.kind;
    if (kind != "grid" && kind != "lhs" && kind != "sobol") return;
    bool begun = false;
    for (std::size_t q = 0; q < objectives_; ++q) {
      const std::vector<FirstOrderIndex> found = first_order_indices(table_, q);
      if (found.empty()) continue;
      if (!std::exchange(begun, true)) {
        heading("Which parameters matter",
                "Sobol's first-order index: the part of an objective's variance that a parameter "
                "explains by itself, with the interval of 95 in 100 resamplings.");
      }
      const auto count = static_cast<double>(found.size());
      Chart chart(460, 60.0 + 34.0 * count, {.label = objective(q), .min = 0.0, .max = 1.0},
                  {.label = "", .min = -0.6, .max = count - 0.2});
      for (std::size_t k = 0; k < found.size(); ++k) {
        const double at = count - 1.0 - static_cast<double>(k);
        chart.bar(at, found[k].value, found[k].low, found[k].high);
        chart.name(at,
                   fmt::format("{}  {:.2f} ({:.2f} to {:.2f})", table_.headings.parameters[k].key,
                               found[k].value, found[k].low, found[k].high));
      }
      add(fmt::format("indices-{}.svg", objective(q)), chart.svg());
    }
  }

  void best() {
    if (front_.empty()) return;
    heading(objectives_ >= 2 ? "Designs of the front" : "The best design",
            objectives_ >= 2 ? "In the order of the first objective." : "");
    body_ += "<table><tr><th>design</th>";
    for (const auto& parameter : table_.headings.parameters) {
      body_ += fmt::format("<th>{}</th>", escaped(parameter.key));
    }
    for (const auto& quantity : table_.headings.quantities) {
      body_ += fmt::format("<th>{}<br><small>{}</small></th>", escaped(quantity.name),
                           escaped(quantity.what));
    }
    body_ += "</tr>";
    const std::size_t step = 1 + (front_.size() - 1) / kMostBest;
    for (std::size_t i = 0; i < front_.size(); i += step) {
      const StudyRow& row = table_.rows[front_[i]];
      body_ += fmt::format("<tr><td>{}</td>", row.number);
      for (const double value : row.parameters) body_ += fmt::format("<td>{:.5g}</td>", value);
      for (const double value : row.quantities) body_ += fmt::format("<td>{:.4g}</td>", value);
      body_ += "</tr>";
    }
    body_ += "</table>";
  }

  void reasons() {
    std::map<std::string, std::pair<std::size_t, std::string>> kinds;  // without their numbers
    for (const StudyRow& row : table_.rows) {
      if (row.feasible()) continue;
      std::string kind;
      std::ranges::copy_if(row.reason, std::back_inserter(kind),
                           [](char c) { return (c < '0' || c > '9') && c != '.' && c != '-'; });
      auto& [count, first] = kinds[kind];
      if (count++ == 0) first = row.reason;
    }
    if (kinds.empty()) return;
    heading("Designs that are not feasible", "How many, and the first one's reason.");
    std::vector<std::pair<std::size_t, std::string>> sorted;
    sorted.reserve(kinds.size());
    for (const auto& [kind, reason] : kinds) sorted.push_back(reason);
    std::ranges::stable_sort(sorted, std::greater<>(), &std::pair<std::size_t, std::string>::first);
    if (sorted.size() > kMostReasons) sorted.resize(kMostReasons);
    body_ += "<table>";
    for (const auto& [count, reason] : sorted) {
      body_ +=
          fmt::format("<tr><td>{}</td><td class=\"words\">{}</td></tr>", count, escaped(reason));
    }
    body_ += "</table>";
  }

  [[nodiscard]] std::string page() const {
    return fmt::format(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>{0}</title><style>"
        "body{{font:15px/1.5 sans-serif;color:#222;max-width:70rem;margin:2rem auto;padding:0 "
        "1rem}}"
        "h1{{font-size:1.6rem}}h2{{font-size:1.2rem;margin:2rem 0 "
        "0}}svg{{max-width:100%;height:auto}}"
        "table{{border-collapse:collapse;display:block;overflow-x:auto}}th,td{{padding:.2rem .7rem;"
        "border-bottom:1px solid #ddd;text-align:right;font-variant-numeric:tabular-nums}}"
        "td.words{{text-align:left}}</style><h1>{0}</h1><p>{1} designs ({2}), {3} of them feasible"
        "{4}.</p>{5}</html>\n",
        escaped(table_.headings.title), table_.rows.size(), escaped(table_.headings.kind),
        feasible_.size(), table_.finished ? "" : "; the study is not finished", body_);
  }

  const StudyTable& table_;
  std::vector<std::size_t> front_, feasible_;
  std::size_t objectives_ = 0;
  std::string body_;
  std::vector<std::pair<std::string, std::string>> plots_;  ///< files and what is in them
};

}  // namespace

void write_study_report(const StudyTable& table, const fs::path& folder) {
  if (table.rows.empty()) throw InputError("study plot: no design is done yet");
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder, error)) {
    throw InputError(fmt::format("{}: cannot be made a folder", folder.string()));
  }
  Report(table).write(folder);
}

std::string report_so_far(const StudyTable& table) {
  return table.rows.empty() ? std::string() : Report(table).so_far();
}

}  // namespace softfinger
