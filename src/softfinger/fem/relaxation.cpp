#include "softfinger/fem/relaxation.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

// The elastic stress is taken as linear in time over a step, which makes the recurrence
// h' = decay h + fraction gain (stress' - stress) exact (Taylor, Pister, Goudreau 1970).
double decay(const Relaxation::Term& term, double time_step) {
  return std::exp(-time_step / term.time);
}
double gain(const Relaxation::Term& term, double time_step) {
  return -std::expm1(-time_step / term.time) * term.time / time_step;
}

template <typename Of>
void for_each_number(ElementStress& stress, Of&& of) {
  for (std::size_t part = 0; part < 6; ++part) {
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      stress.part[part][lane] = of(part, lane);
    }
  }
}

}  // namespace

double Relaxation::long_time_fraction() const {
  double rest = 1.0;
  for (const Term& term : terms) rest -= term.fraction;
  return rest;
}

double Relaxation::step_fraction(double time_step) const {
  double fraction = long_time_fraction();
  for (const Term& term : terms) fraction += term.fraction * gain(term, time_step);
  return fraction;
}

StressHistory make_history(const Relaxation& relaxation, std::size_t groups) {
  StressHistory history;
  if (relaxation.terms.empty()) return history;
  history.elastic.assign(groups, ElementStress{});
  history.relaxing.assign(relaxation.terms.size(), history.elastic);
  return history;
}

void forget(StressHistory& history) {
  std::fill(history.elastic.begin(), history.elastic.end(), ElementStress{});
  for (auto& term : history.relaxing) std::fill(term.begin(), term.end(), ElementStress{});
}

void recall(const Relaxation& relaxation, const StressHistory& history, double time_step,
            std::vector<ElementStress>& memory) {
  double replaced = 0.0;  // of the old elastic stress, which the step's own takes the place of
  for (const auto& term : relaxation.terms) replaced += term.fraction * gain(term, time_step);
  for (std::size_t g = 0; g < memory.size(); ++g) {
    for_each_number(memory[g], [&](std::size_t part, std::size_t lane) {
      return -replaced * history.elastic[g].part[part][lane];
    });
    for (std::size_t k = 0; k < relaxation.terms.size(); ++k) {
      const double kept = decay(relaxation.terms[k], time_step);
      for_each_number(memory[g], [&](std::size_t part, std::size_t lane) {
        return memory[g].part[part][lane] + kept * history.relaxing[k][g].part[part][lane];
      });
    }
  }
}

void remember(const Relaxation& relaxation, double time_step, std::size_t g,
              const ElementStress& elastic, StressHistory& history) {
  for (std::size_t k = 0; k < relaxation.terms.size(); ++k) {
    const Relaxation::Term& term = relaxation.terms[k];
    const double kept = decay(term, time_step);
    const double added = term.fraction * gain(term, time_step);
    ElementStress& h = history.relaxing[k][g];
    for_each_number(h, [&](std::size_t part, std::size_t lane) {
      return kept * h.part[part][lane] +
             added * (elastic.part[part][lane] - history.elastic[g].part[part][lane]);
    });
  }
  history.elastic[g] = elastic;
}

}  // namespace softfinger
