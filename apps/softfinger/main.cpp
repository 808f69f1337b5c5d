#include <fmt/core.h>

#include <exception>

#include "commands.hpp"
#include "softfinger/base/error.hpp"

int main(int argc, char** argv) {
  CLI::App app{"softfinger: tactile rendering for wearable fingertip haptics", "softfinger"};
  app.set_version_flag("--version", "softfinger " SOFTFINGER_VERSION);
  app.require_subcommand(1);
  add_run_command(app);
  add_press_command(app);
  add_match_command(app);
  add_evaluate_command(app);
  add_device_command(app);
  add_finger_command(app);
  add_scene_command(app);
  add_replay_command(app);
  add_export_command(app);
  add_condition_command(app);
  add_emulate_command(app);
  add_help_command(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::RuntimeError& end) {
    return end.get_exit_code();
  } catch (const CLI::Success& end) {
    return app.exit(end);
  } catch (const CLI::RequiredError& error) {
    if (argc > 1 && app.get_subcommands().empty()) {
      fmt::print(stderr, "softfinger: no command '{}'; softfinger help lists them\n", argv[1]);
      return 2;
    }
    fmt::print(stderr, "softfinger: {} (see softfinger help)\n", error.what());
    return 2;
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "softfinger: {} (see softfinger --help)\n", error.what());
    return 2;
  } catch (const softfinger::InputError& error) {
    fmt::print(stderr, "softfinger: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "softfinger: {}\n", error.what());
    return 1;
  }
}
