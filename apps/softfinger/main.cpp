#include <fmt/format.h>

#include <exception>
#include <string>
#include <system_error>

#include "commands.hpp"
#include "softfinger/base/error.hpp"
#include "standard_output.hpp"
#include "stop_signal.hpp"

namespace {

/// Of the parser's own words for a value that is no such number.
std::string conversion_message(const std::string& words) {
  const std::size_t colon = words.find(": ");
  const std::size_t equals = words.find(" = ");
  if (colon == std::string::npos || equals == std::string::npos || equals < colon) return words;
  return fmt::format("{} {}: not a number that it takes",
                     words.substr(colon + 2, equals - colon - 2), words.substr(equals + 3));
}

int run(CLI::App& app, int argc, char** argv) {
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
  } catch (const CLI::ConversionError& error) {
    fmt::print(stderr, "softfinger: {} (see softfinger --help)\n",
               softfinger::in_one_line(conversion_message(error.what())));
    return 2;
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "softfinger: {} (see softfinger --help)\n",
               softfinger::in_one_line(error.what()));
    return 2;
  } catch (const softfinger::InputError& error) {
    fmt::print(stderr, "softfinger: {}\n", error.what());
    return 2;
  } catch (const std::system_error& error) {
    // Printing throws it where a buffer cannot be emptied; main() says that.
    if (!output_is_lost()) fmt::print(stderr, "softfinger: {}\n", error.what());
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "softfinger: {}\n", error.what());
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  occupy_standard_streams();
  outlive_quotas();
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
  add_study_command(app);
  add_replay_command(app);
  add_export_command(app);
  add_condition_command(app);
  add_emulate_command(app);
  add_help_command(app);
  add_complete_command(app);
  add_manual_command(app);
  return status_of_output(run(app, argc, argv));
}
