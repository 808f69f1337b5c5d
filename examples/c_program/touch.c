/* A finger goes down onto what lies under it; contact and the device's answer, ten times a second.
   Here the pose is made up: put your tracker's in its place. */
#include <softfinger/softfinger.h>
#include <stdio.h>

int main(int argc, char **argv) {
  char error[512];
  sf_rendering *rendering = NULL;
  double most_force = 0.0;
  int i;
  if (argc != 2) {
    fprintf(stderr, "usage: touch SCENE\n");
    return 2;
  }
  if (sf_rendering_create(argv[1], NULL, &rendering, error, sizeof error) != SF_DONE) {
    fprintf(stderr, "touch: %s\n", error);
    return 2;
  }
  for (i = 0; i <= 1000; ++i) {
    const double time_s = 1e-3 * i; /* a live program takes its clock */
    sf_pose X_WFt = {sizeof(sf_pose), {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
    sf_command command = {sizeof(sf_command)};
    sf_contact contact = {sizeof(sf_contact)};
    uint32_t joint;
    X_WFt.position_m[2] = 30e-3 - 6e-3 * time_s; /* 30 mm above the origin, then down at 6 mm/s */
    if (sf_rendering_step(rendering, &X_WFt, time_s, &command) != SF_DONE ||
        sf_rendering_contact(rendering, &contact) != SF_DONE) {
      sf_rendering_message(rendering, error, sizeof error);
      fprintf(stderr, "touch: %s\n", error);
      break;
    }
    if (contact.normal_force_N > most_force) most_force = contact.normal_force_N;
    if (i % 100 != 0) continue;
    printf("%.1f s  %6.3f N  %5.1f mm2  joints", time_s, contact.normal_force_N,
           1e6 * contact.contact_area_m2);
    for (joint = 0; joint < command.joint_count; ++joint) printf(" %6.3f", command.joints[joint]);
    printf(" rad\n");
  }
  sf_rendering_destroy(rendering);
  return i > 1000 && most_force > 0.0 ? 0 : 1;
}
