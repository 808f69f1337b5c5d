#include <fmt/core.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "commands.hpp"
#include "guard_option.hpp"
#include "port_option.hpp"
#include "progress_bar.hpp"
#include "shipped_option.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/instruction_set.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/report/run_report.hpp"
#include "softfinger/session/scene_load.hpp"
#include "softfinger/tracking/tracker_spec.hpp"
#include "softfinger/viewer/server.hpp"
#include "stop_signal.hpp"

namespace {

constexpr int kMostThreads = 64;
constexpr double kMostPrediction_ms = softfinger::PoseConditioning::kMostLead / softfinger::ms;

using namespace softfinger;

struct RunFlags {
  RunOptions options;
  std::optional<double> duration_s;
  std::optional<double> predict_ms;
  bool filter = false;
  std::string recording;
  std::string wearer;
  std::string person;
  std::string simd;
  bool headless = false;
  bool repeat = false;
  bool no_twin = false;
  bool json = false;
  std::uint16_t port = 8080;
  std::optional<std::string> listen;  ///< this machine alone where not given
  std::optional<std::string> token;
  Certificate certificate;
  bool plain_http = false;
};

void check(const RunFlags& flags) {
  if (flags.duration_s && !(std::isfinite(*flags.duration_s) && *flags.duration_s > 0.0)) {
    throw InputError(
        fmt::format("--duration-s {}: must be a time above 0 in seconds", *flags.duration_s));
  }
  if (flags.predict_ms && !(*flags.predict_ms >= 0.0 && *flags.predict_ms <= kMostPrediction_ms)) {
    throw InputError(fmt::format("--predict-ms {}: must be a time of 0 to {} in milliseconds",
                                 *flags.predict_ms, kMostPrediction_ms));
  }
  if (flags.options.threads < 1 || flags.options.threads > kMostThreads) {
    throw InputError(
        fmt::format("--threads {}: must be 1 to {}", flags.options.threads, kMostThreads));
  }
  if (flags.options.as_fast_as_possible && !flags.headless) {
    throw InputError(
        "--as-fast-as-possible: a live run keeps to the wall clock; give --headless as well");
  }
  if (flags.options.record_state && flags.recording.empty()) {
    throw InputError("--record-state: needs --record FILE");
  }
  if (flags.repeat && flags.headless) {
    throw InputError("--repeat: only for a live run, without --headless");
  }
  if (flags.no_twin && flags.headless) {
    throw InputError("--no-twin: a headless run has no twin; leave it out");
  }
  if (flags.headless &&
      (flags.listen || flags.token || flags.certificate.is_given() || flags.plain_http)) {
    throw InputError(fmt::format("{}: a headless run serves no page; leave it out",
                                 flags.listen                      ? "--listen"
                                 : flags.token                     ? "--token"
                                 : flags.plain_http                ? "--plain-http"
                                 : flags.certificate.chain.empty() ? "--key"
                                                                   : "--certificate"));
  }
  if (flags.plain_http && flags.certificate.is_given()) {
    throw InputError("--plain-http: with --certificate the page is served by HTTPS; leave one out");
  }
}

PagePort page_port(const RunFlags& flags) {
  ServerOptions server_options;
  server_options.port = flags.port;
  if (flags.listen) server_options.address = *flags.listen;
  if (flags.token) server_options.token = AccessToken::read(*flags.token);
  server_options.certificate = flags.certificate;
  server_options.plain_http = flags.plain_http;
  return PagePort(server_options);
}

RunSummary run_live(const RunFlags& flags, PagePort port, std::shared_ptr<const RunSetup> setup,
                    const std::atomic<bool>& stop, const RunObserver& observer) {
  LiveSession session(std::move(setup), flags.options, flags.repeat);
  const Server server(session, std::move(port));
  fmt::print(flags.json ? stderr : stdout, "softfinger: {} (Ctrl-C ends)\n", server.url());
  std::fflush(stdout);
  return session.run(stop, observer);
}

void run(RunFlags flags) {
  check(flags);
  if (!flags.simd.empty()) choose_instruction_set(flags.simd);
  flags.options.duration = flags.duration_s;
  if (flags.filter) flags.options.conditioning.filter.emplace();
  if (flags.predict_ms) flags.options.conditioning.lead = *flags.predict_ms * ms;
  if (!flags.wearer.empty()) flags.options.wearer = flags.wearer;
  if (!flags.person.empty()) flags.options.person = flags.person;
  flags.options.person_may_be_new = !flags.headless;  // the page may register a finger
  flags.options.twin = !flags.no_twin;
  if (!flags.recording.empty()) flags.options.recording = flags.recording;
  flags.options.actuator.guard_program = guard_program();
  const std::atomic<bool>& stop = stop_on_signals();
  flags.options.stop_signals = &stop_devices_on_signals();

  ProgressBar bar;
  flags.options.load_observer = load_observer(bar);
  RunObserver observer;
  observer.message = [&bar](const std::string& message) {
    bar.clear();
    fmt::print(stderr, "softfinger: {}\n", message);
  };
  if (flags.headless) {
    observer.progress = [&bar](double time, std::optional<double> end) {
      if (end && *end > 0.0) bar.show(time / *end);
    };
  }
  // What can be refused is, before the scene, which may take minutes, and before any device.
  if (flags.options.recording) refuse_unless_recordable(*flags.options.recording);
  std::optional<PagePort> port;
  if (!flags.headless) port.emplace(page_port(flags));
  std::shared_ptr<const RunSetup> setup = load_unless_stopped(flags.options, stop);
  bar.clear();
  RunSummary summary;
  if (!setup) {
    observer.message("ended while the scene was loading");
    if (!flags.json) return;
  } else if (flags.headless) {
    summary = run_headless(std::move(setup), flags.options, stop, observer);
  } else {
    summary = run_live(flags, std::move(*port), std::move(setup), stop, observer);
  }
  bar.clear();
  for (const std::string& remark : summary.remarks) observer.message(remark);
  if (flags.json) {
    fmt::print("{}\n", run_report(summary).dump(2));
  } else {
    fmt::print("{}", run_report_text(summary));
  }
}

}  // namespace

void add_run_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("run", "Run a scene: live with a page in the browser, or headless");
  auto flags = std::make_shared<RunFlags>();
  RunOptions& options = flags->options;
  takes_shipped(command->add_option("SCENE", options.scene,
                                    "scene file (TOML), or the name of a shipped one"),
                Shipped::kScene)
      ->required();
  command->add_flag("--headless", flags->headless, "no page");
  command->add_option("--duration-s", flags->duration_s, "end after this time, s");
  command
      ->add_option("--device", options.devices,
                   "device file instead of the scene's; NAME=FILE for one of several fingers")
      ->type_name(value_name(Shipped::kDevice))
      ->allow_extra_args(false);
  command
      ->add_option(
          "--tracker", options.trackers,
          fmt::format("tracker instead of the scene's: {}; NAME=SPEC for one of several fingers",
                      trackers_in_brief("or", [](const TrackerRow&) { return true; })))
      ->allow_extra_args(false);
  command->add_flag("--filter", flags->filter,
                    "smooth tracked poses: little jitter at rest, little lag in motion");
  command->add_option("--predict-ms", flags->predict_ms,
                      "carry tracked poses on over their age and this time more, ms");
  takes_shipped(
      command->add_option(
          "--wearer", flags->wearer,
          "finger file of whom an emulated force sensor, and the page's twin, are on; the "
          "simulated finger where not given"),
      Shipped::kFinger);
  command->add_option(
      "--person", flags->person,
      "person file: sizes, skin and mounts of the fingers, where tracked bodies sit on them");
  command->add_option("--record", flags->recording, "record into this new file");
  command->add_flag("--record-state", options.record_state,
                    "record all nodes and samples of every step as well");
  command->add_option("--listen", flags->listen,
                      "address that the page is served at, 127.0.0.1 where not given; others than "
                      "this machine's need --token, and --certificate or --plain-http");
  command->add_option("--token", flags->token,
                      "file with a secret that visitors of the page must know");
  command->add_option("--certificate", flags->certificate.chain,
                      "PEM file: the page is served by HTTPS; needs --key");
  command->add_option("--key", flags->certificate.key,
                      "PEM file with the private key of --certificate");
  command->add_flag(
      "--plain-http", flags->plain_http,
      "the network is trusted: --listen without --certificate, for all on it to read");
  add_port_option(*command, "--port", flags->port, "port of the page; 0: any free one");
  command->add_flag("--as-fast-as-possible", options.as_fast_as_possible,
                    "headless: do not keep to the wall clock");
  command->add_flag("--wait-for-device", options.actuator.wait_for_device,
                    "start although a device's port is absent, and connect when it appears");
  command->add_flag("--repeat", flags->repeat, "live: a script that ends starts over");
  command->add_flag("--no-twin", flags->no_twin,
                    "live: do not press a second finger with the device's surface for the page");
  command->add_option("--threads", options.threads,
                      "that step several fingers side by side, or one with a large mesh");
  command->add_option("--events", options.events,
                      "osc:HOST:PORT: what happens to objects that move (impact, release, click, "
                      "detent, limit) is sent there at once");
  command->add_option("--simd", flags->simd,
                      fmt::format("instruction set: {}", listed(names_of(kInstructionSets), "or")));
  command->add_flag("--json", flags->json, "one JSON object on stdout");
  command->callback([flags] { run(*flags); });
}
