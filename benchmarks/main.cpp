// Benchmarks of the project, with what their numbers depend on written above them.

#include <benchmark/benchmark.h>

#include <fstream>
#include <string>

#include "softfinger/base/instruction_set.hpp"

namespace {

/// The processor as Linux names it; empty where it does not.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::AddCustomContext("processor", processor());
  benchmark::AddCustomContext(
      "instruction_set", std::string(softfinger::name_of(softfinger::active_instruction_set())));
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
