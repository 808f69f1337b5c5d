/* The device of a scene, live: the finger rests on what is under it until Ctrl-C, which stops the
   device. However this program ends, softfinger-guard retracts the device. */
#define _POSIX_C_SOURCE 200809L
#include <signal.h>
#include <softfinger/softfinger.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static sf_rendering *rendering;
static volatile sig_atomic_t interrupted;

static void stop(int signal_number) {
  (void)signal_number;
  interrupted = 1;
  sf_rendering_stop(rendering); /* allowed here, and from any thread */
}

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argc, char **argv) {
  const struct timespec pause = {0, 2000000};
  sf_options options = {sizeof(sf_options)};
  sf_pose X_WFt = {sizeof(sf_pose), {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
  sf_command command = {sizeof(sf_command)};
  char error[512];
  double start;
  if (argc < 3) {
    fprintf(stderr, "usage: live SCENE HEIGHT_MM [GUARD_PROGRAM]\n");
    return 2;
  }
  options.open_device = 1;
  options.guard_program = argc > 3 ? argv[3] : NULL;
  X_WFt.position_m[2] = 1e-3 * atof(argv[2]);
  if (sf_rendering_create(argv[1], &options, &rendering, error, sizeof error) != SF_DONE) {
    fprintf(stderr, "live: %s\n", error);
    return 2;
  }
  signal(SIGINT, stop);
  start = seconds();
  while (!interrupted && sf_rendering_step(rendering, &X_WFt, seconds() - start, &command) == SF_DONE) {
    nanosleep(&pause, NULL);
  }
  sf_rendering_message(rendering, error, sizeof error);
  if (error[0] != '\0') fprintf(stderr, "live: %s\n", error);
  printf("state %d after %.1f s\n", (int)command.state, seconds() - start);
  sf_rendering_destroy(rendering); /* waits until the device is retracted */
  return error[0] != '\0';
}
