#include "scratch_file.hpp"
#include "softfinger/identification/indentation_data.hpp"

extern "C" int fuzz_indentation_csv(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  static const ScratchFile file("measured.csv");
  file.write({data, size});
  read_or_refuse([] {
    const MeasuredColumns curve = read_indentation_curve(file.path());
    double last = -1.0;
    for (std::size_t i = 0; i < curve.first.size(); ++i) {
      if (!(curve.first[i] > last) || !(curve.second[i] >= 0.0)) __builtin_trap();
      last = curve.first[i];
    }
  });
  read_or_refuse([] {
    const MeasuredColumns areas = read_contact_areas(file.path());
    for (std::size_t i = 0; i < areas.first.size(); ++i) {
      if (!(areas.first[i] > 0.0) || !(areas.second[i] > 0.0)) __builtin_trap();
    }
  });
  return 0;
}
