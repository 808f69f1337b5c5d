#include "contact_points_file.hpp"
#include "scratch_file.hpp"

extern "C" int fuzz_points(const std::uint8_t* data, std::size_t size) {
  static const softfinger::ScratchFile file("points.json");
  file.write({data, size});
  softfinger::read_or_refuse([] {
    const ContactPointsFile points = read_contact_points(file.path());
    if (points.in_contact.size() != points.points_F.size()) __builtin_trap();
  });
  return 0;
}
