#include "softfinger/session/evaluation.hpp"

#include <fmt/core.h>

#include <memory>

#include "softfinger/base/error.hpp"
#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/session/rendering_judge.hpp"
#include "softfinger/session/scene_load.hpp"
#include "softfinger/twin/area_spread.hpp"

namespace softfinger {

Evaluation evaluate(const EvaluationOptions& options, const std::atomic<bool>& stop,
                    const RunObserver& observer) {
  RunOptions run = options.run;
  run.as_fast_as_possible = true;
  run.actuator.port = "emulator";
  const std::shared_ptr<const RunSetup> setup = load_unless_stopped(run, stop);
  if (!setup) throw OperationError("evaluate: ended while the scene was loading");
  if (setup->models.empty()) {
    throw InputError(
        fmt::format("{}: has no finger to judge a device by", setup->scene.file.string()));
  }
  std::vector<RenderingJudge> judges;
  Evaluation answer;
  answer.has_lagged = options.sides.lagged;
  answer.has_loaded = options.sides.loaded;
  for (std::size_t i = 0; i < setup->models.size(); ++i) {
    const std::string& name = setup->scene.fingers[i].name;
    if (!setup->devices[i]) {
      throw InputError(fmt::format("{}: finger {} has no device to judge; give it one, or --device",
                                   setup->scene.file.string(), name));
    }
    if (run.objective != nullptr) {
      const std::string why = why_not(*run.objective, *setup->devices[i]);
      if (!why.empty()) {
        throw InputError(
            fmt::format("--objective: {}: {}", setup->scene.fingers[i].device->string(), why));
      }
    }
    judges.emplace_back(setup->models[i], setup->wearer ? setup->wearer : setup->models[i],
                        setup->worn[i] ? setup->worn[i] : setup->devices[i], options.sides);
    answer.fingers.push_back(name);
    answer.linear_motors.push_back(setup->devices[i]->joint_limits().linear);
  }
  SceneRun::Hooks hooks;
  hooks.on_tick = [&](std::size_t finger, const FingerChain& chain) {
    judges[finger].judge(chain.virtual_finger(), chain.device(), answer);
  };
  answer.run = run_headless(setup, run, stop, observer, std::move(hooks));
  for (std::size_t i = 0; setup->wearer && i < judges.size(); ++i) {
    judges[i].check_cover();
  }
  return answer;
}

AreaSpreadRates area_spread_rates(const Evaluation& evaluation, std::size_t finger) {
  AreaSpread virtual_side, twin;
  for (const EvaluatedFrame& frame : evaluation.frames) {
    if (frame.finger != finger || frame.commanded.kind != FrameKind::kBoth) continue;
    virtual_side.add(frame.virtual_force_sum, frame.virtual_area);
    twin.add(frame.twin_force_sum, frame.twin_area);
  }
  return {virtual_side.rate(), twin.rate()};
}

}  // namespace softfinger
