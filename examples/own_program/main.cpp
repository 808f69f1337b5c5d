// A finger goes down onto what lies under it; the device's answer is printed ten times a second.
// Here the pose is made up: put your tracker's in its place.
#include <cstdio>
#include <exception>

#include "softfinger/rendering.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: own_program SCENE\n");
    return 2;
  }
  try {
    softfinger::Rendering rendering(argv[1]);
    double most_force = 0.0;
    for (int i = 0; i <= 1000; ++i) {
      const double time = 1e-3 * i;  // s; a live program takes its clock
      softfinger::Pose X_WFt;        // 30 mm above the origin, then down at 6 mm/s
      X_WFt.translation.z() = 30e-3 - 6e-3 * time;
      const softfinger::RenderingCommand& command = rendering.step(X_WFt, time);
      if (i % 100 != 0) continue;
      const softfinger::RenderingSnapshot finger = rendering.snapshot();
      std::printf("%.1f s  %6.3f N  %5.1f mm2  joints", time, finger.normal_force,
                  1e6 * finger.contact_area);
      for (const double joint : command.joints) std::printf(" %6.3f", joint);
      std::printf(" rad\n");
      if (finger.normal_force > most_force) most_force = finger.normal_force;
    }
    return most_force > 0.0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "own_program: %s\n", error.what());
    return 2;
  }
}
