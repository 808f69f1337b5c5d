/* An exploration by the C interface, and sizes of its structs, as LibraryTest.cs prints them: numbers as their bits. */
#include <inttypes.h>
#include <softfinger/softfinger.h>
#include <stdio.h>
#include <string.h>

static void print(const char *name, const double *values, size_t count) {
  size_t i;
  printf("%s", name);
  for (i = 0; i < count; ++i) {
    uint64_t bits;
    memcpy(&bits, &values[i], sizeof bits);
    printf(" %016" PRIx64, bits);
  }
  printf("\n");
}

static void print_sizes(void) {
  printf("sizes %zu %zu %zu %zu %zu %zu %zu %zu %zu %zu %zu %zu\n", sizeof(sf_options), sizeof(sf_pose),
         sizeof(sf_unity_pose), sizeof(sf_command), sizeof(sf_contact), sizeof(sf_info),
         sizeof(sf_press_options), sizeof(sf_evaluate_options),
         sizeof(sf_run_options), sizeof(sf_device_info),
         sizeof(sf_points), sizeof(sf_match));
}

static void print_pose(const char *name, const sf_pose *pose) {
  print(name, pose->position_m, 3);
  print(name, pose->quaternion_wxyz, 4);
}

static void print_command(const sf_command *command) {
  printf("command %d %" PRId64 " %d %d %u\n", command->state, command->tick, command->stopped,
         command->stop_confirmed, command->stops);
  print("time", &command->time_s, 1);
  print("deviation", &command->deviation_m2, 1);
  print("configuration", command->configuration, command->configuration_count);
  print("joints", command->joints, command->joint_count);
  print("set_points", command->set_points, command->set_point_count);
}

static void print_contact(const sf_contact *contact) {
  printf("contact %u\n", contact->samples_in_contact);
  print("time", &contact->time_s, 1);
  print("normal", &contact->normal_force_N, 1);
  print("tangential", &contact->tangential_force_N, 1);
  print("area", &contact->contact_area_m2, 1);
  print("centroid", contact->centroid_F_m, 3);
  print("mean_normal", contact->mean_normal_F, 3);
  print("normal_sum", &contact->normal_force_sum_N, 1);
  print("slip", &contact->slip_ratio, 1);
}

static void print_skin(const sf_rendering *rendering) {
  static double xyz[30000], pressures[10000];
  static uint8_t in_contact[10000];
  static uint32_t corners[60000];
  size_t samples = 0, triangles = 0, i;
  sf_rendering_positions(rendering, xyz, 10000, &samples);
  print("positions", xyz, 3 * samples);
  sf_rendering_pressures(rendering, pressures, 10000, &samples);
  print("pressures", pressures, samples);
  sf_rendering_in_contact(rendering, in_contact, 10000, &samples);
  printf("in_contact");
  for (i = 0; i < samples; ++i) printf(" %d", in_contact[i]);
  sf_rendering_triangles(rendering, corners, 20000, &triangles);
  printf("\ntriangles");
  for (i = 0; i < 3 * triangles; ++i) printf(" %u", corners[i]);
  printf("\n");
}

static void print_rest(sf_rendering *rendering) {
  char name[256];
  sf_info info = {sizeof(sf_info)};
  sf_pose X_WFt = {sizeof(sf_pose)}, X_WF = {sizeof(sf_pose)}, X_WO = {sizeof(sf_pose)};
  sf_unity_pose unity = {sizeof(sf_unity_pose)};
  size_t i;
  sf_rendering_info(rendering, &info);
  printf("info %u %u %u %u %u\n", info.sample_count, info.triangle_count, info.object_count,
         info.configuration_count, info.joint_count);
  print("rates", &info.simulation_rate_Hz, 2);
  sf_rendering_poses(rendering, &X_WFt, &X_WF);
  print_pose("X_WFt", &X_WFt);
  print_pose("X_WF", &X_WF);
  sf_pose_to_unity(&X_WF, &unity);
  print("unity", unity.position_m, 3);
  print("unity", unity.quaternion_xyzw, 4);
  for (i = 0; i < info.object_count; ++i) {
    sf_rendering_object_name(rendering, i, name, sizeof name, NULL);
    sf_rendering_object_pose(rendering, i, &X_WO);
    print_pose(name, &X_WO);
  }
  for (i = 0; i < info.configuration_count; ++i) {
    sf_rendering_configuration_name(rendering, i, name, sizeof name, NULL);
    printf("%s\n", name);
  }
}

int main(int argc, char **argv) {
  char error[512];
  sf_rendering *rendering = NULL;
  int i;
  sf_options options = {sizeof(sf_options)};
  if (argc != 3) return 2; /* SCENE DEVICE */
  options.device = argv[2];
  print_sizes();
  if (sf_rendering_create(argv[1], &options, &rendering, error, sizeof error) != SF_DONE) {
    fprintf(stderr, "%s\n", error);
    return 2;
  }
  for (i = 0; i <= 500; ++i) {
    const double time_s = i / 1000.0, depth = time_s / 0.5;
    sf_pose X_WFt = {sizeof(sf_pose), {0, 0, 0}, {0.9987502603949663, 0, 0.04997916927067833, 0}};
    sf_command command = {sizeof(sf_command)};
    sf_contact contact = {sizeof(sf_contact)};
    X_WFt.position_m[0] = 2e-3 * depth;
    X_WFt.position_m[2] = 8.5e-3 - 4e-3 * depth;
    if (i == 300) {
      sf_rendering_lost(rendering, time_s, &command);
    } else if (sf_rendering_step(rendering, &X_WFt, time_s, &command) != SF_DONE) {
      return 1;
    }
    if (i % 20 != 0) continue;
    sf_rendering_contact(rendering, &contact);
    print_command(&command);
    print_contact(&contact);
  }
  print_skin(rendering);
  print_rest(rendering);
  sf_rendering_destroy(rendering);
  return 0;
}
