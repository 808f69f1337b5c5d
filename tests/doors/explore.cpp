// An exploration by the C++ interface, recorded; as explore.c.
#include <array>
#include <cstdio>
#include <exception>
#include <fstream>

#include "softfinger/rendering.hpp"

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  try {
    softfinger::Rendering rendering(argv[1], {.device = argv[2], .recording = argv[4]});
    std::ifstream motion(argv[3], std::ios::binary);
    std::array<double, 8> row{};
    while (motion.read(reinterpret_cast<char*>(row.data()), sizeof row)) {
      softfinger::Pose X_WFt;
      X_WFt.translation = {row[1], row[2], row[3]};
      X_WFt.rotation =
          Eigen::Quaterniond(row[4], row[5], row[6], row[7]).normalized().toRotationMatrix();
      rendering.step(X_WFt, row[0]);
    }
    rendering.close_recording();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "explore: %s\n", error.what());
    return 1;
  }
}
