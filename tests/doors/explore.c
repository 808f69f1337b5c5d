/* An exploration by the C interface, recorded: explore SCENE DEVICE MOTION RECORDING. MOTION has eight doubles a step:
   time, s; position, m; quaternion w x y z. */
#include <softfinger/softfinger.h>
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv) {
  sf_options options = {sizeof(sf_options)};
  sf_rendering *rendering = NULL;
  char error[512] = "";
  double row[8];
  FILE *motion;
  sf_status status = SF_DONE;
  if (argc != 5 || (motion = fopen(argv[3], "rb")) == NULL) return 2;
  options.device = argv[2];
  options.recording = argv[4];
  if (sf_rendering_create(argv[1], &options, &rendering, error, sizeof error) != SF_DONE) {
    fprintf(stderr, "explore: %s\n", error);
    fclose(motion);
    return 2;
  }
  while (status == SF_DONE && fread(row, sizeof row, 1, motion) == 1) {
    sf_pose X_WFt = {sizeof(sf_pose), {row[1], row[2], row[3]}, {0.0}};
    memcpy(X_WFt.quaternion_wxyz, row + 4, sizeof X_WFt.quaternion_wxyz);
    status = sf_rendering_step(rendering, &X_WFt, row[0], NULL);
  }
  fclose(motion);
  if (status != SF_DONE) sf_rendering_message(rendering, error, sizeof error);
  if (status == SF_DONE) {
    status = sf_rendering_close_recording(rendering, error, sizeof error);
  }
  sf_rendering_destroy(rendering);
  if (status != SF_DONE) fprintf(stderr, "explore: %s\n", error);
  return (int)status;
}
