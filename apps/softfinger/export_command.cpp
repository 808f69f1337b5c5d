#include <fmt/core.h>

#include <atomic>
#include <memory>
#include <string>

#include "commands.hpp"
#include "progress_bar.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/export/export_recording.hpp"
#include "stop_signal.hpp"

void add_export_command(CLI::App& app) {
  struct Flags {
    std::string recording, to;
  };
  CLI::App* command = app.add_subcommand("export", "Write a recording for other programs");
  auto flags = std::make_shared<Flags>();
  command->add_option("RECORDING", flags->recording, "what run --record wrote")->required();
  command
      ->add_option("--to", flags->to,
                   "FILE.h5: HDF5, FILE.mcap: MCAP; else a directory for CSV files, made if absent")
      ->required();
  command->callback([flags] {
    const std::atomic<bool>& stop = stop_on_signals();
    ProgressBar bar;
    const std::string cut =
        softfinger::export_recording(flags->recording, flags->to, [&](double fraction) {
          if (stop) throw softfinger::OperationError("export: stopped; nothing was written");
          bar.show(fraction);
        });
    bar.clear();
    if (!cut.empty()) fmt::print(stderr, "softfinger: {}\n", cut);
  });
}
