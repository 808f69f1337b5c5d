#include "softfinger/fem/relaxation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace softfinger {
namespace {

const Relaxation kRelaxation{{{0.3, 4e-3}, {0.2, 70e-3}, {0.25, 1.4}}};

ElementStress filled(double value) {
  ElementStress stress;
  for (auto& part : stress.part) std::fill(std::begin(part), std::end(part), value);
  return stress;
}

/// Stress after each step where the elastic stress follows `elastic(t)`, by the recurrence.
template <typename Elastic>
std::vector<double> stepped(const Relaxation& relaxation, Elastic&& elastic, double time_step,
                            int steps) {
  StressHistory history = make_history(relaxation, 1);
  std::vector<ElementStress> memory(1);
  std::vector<double> stress;
  for (int k = 1; k <= steps; ++k) {
    recall(relaxation, history, time_step, memory);
    const double now = elastic(k * time_step);
    stress.push_back(relaxation.step_fraction(time_step) * now + memory[0].part[4][3]);
    remember(relaxation, time_step, 0, filled(now), history);
  }
  return stress;
}

/// Ramp to 1 in time T, then held: the convolution in closed form.
double ramp_and_hold(const Relaxation& relaxation, double ramp, double t) {
  double stress = relaxation.long_time_fraction() * std::min(1.0, t / ramp);
  for (const auto& [g, tau] : relaxation.terms) {
    const double risen = std::min(t, ramp);
    stress += g * tau / ramp * (std::exp(-(t - risen) / tau) - std::exp(-t / tau));
  }
  return stress;
}

TEST(Relaxation, RampAndHoldIsTheConvolutionWhateverTheTimeStep) {
  for (const double time_step : {0.5e-3, 4e-3, 20e-3}) {
    const double ramp = 0.1;
    const auto stress = stepped(
        kRelaxation, [&](double t) { return std::min(1.0, t / ramp); }, time_step,
        static_cast<int>(3.0 / time_step));
    for (std::size_t k = 0; k < stress.size(); ++k) {
      const double t = static_cast<double>(k + 1) * time_step;
      EXPECT_NEAR(stress[k], ramp_and_hold(kRelaxation, ramp, t), 1e-10) << t;
    }
  }
}

TEST(Relaxation, SinusoidDissipatesAsTheLossModulusSays) {
  const double omega = 2.0 * M_PI * 2.0;
  double loss = 0.0;  // G''
  for (const auto& [g, tau] : kRelaxation.terms) {
    loss += g * omega * tau / (1.0 + omega * omega * tau * tau);
  }
  const double time_step = 0.25e-3;
  const auto elastic = [&](double t) { return std::sin(omega * t); };
  const auto stress = stepped(kRelaxation, elastic, time_step, 40000);
  double work = 0.0;  // of the last period, 0.5 s
  for (std::size_t k = stress.size() - 2000; k < stress.size(); ++k) {
    const double t = static_cast<double>(k + 1) * time_step;
    work += 0.5 * (stress[k] + stress[k - 1]) * (elastic(t) - elastic(t - time_step));
  }
  EXPECT_NEAR(work, M_PI * loss, 1e-3 * M_PI * loss);
}

TEST(Relaxation, ForgettingLeavesNothing) {
  StressHistory history = make_history(kRelaxation, 1);
  remember(kRelaxation, 1e-3, 0, filled(5.0), history);
  forget(history);
  std::vector<ElementStress> memory(1);
  recall(kRelaxation, history, 1e-3, memory);
  EXPECT_EQ(memory[0].part[2][1], 0.0);
}

}  // namespace
}  // namespace softfinger
