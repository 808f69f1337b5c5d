/* A finger pressed on a plate, row by row; then the same pose as game engines have it.

       press FINGER */
#include <softfinger/softfinger.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Values of a column by name; the caller frees them. */
static double *column(const sf_table *table, const char *wanted, size_t rows) {
  char name[64];
  for (size_t i = 0; sf_table_name(table, i, name, sizeof name, NULL) == SF_DONE; ++i) {
    if (strcmp(name, wanted) != 0) continue;
    double *values = malloc(rows * sizeof *values);
    if (values != NULL) sf_table_column(table, i, values, rows, NULL);
    return values;
  }
  return NULL;
}

static int press(const char *finger) {
  const sf_press_options options = {.size = sizeof options, .rows = 5, .depth_m = 1.5e-3};
  sf_table *table = NULL;
  char error[512];
  if (sf_press(finger, &options, &table, error, sizeof error) != SF_DONE) {
    fprintf(stderr, "press: %s\n", error);
    return EXIT_FAILURE;
  }
  size_t rows = 0;
  sf_table_size(table, &rows, NULL);
  double *depth = column(table, "indentation_mm", rows);
  double *force = column(table, "normal_force_N", rows);
  double *area = column(table, "contact_area_mm2", rows);
  const int complete = depth != NULL && force != NULL && area != NULL && rows == 5;
  for (size_t i = 0; complete && i < rows; ++i) {
    printf("%.2f mm  %.3f N  %5.1f mm2\n", depth[i], force[i], area[i]);
  }
  const int touched = complete && force[rows - 1] > 0.0;
  free(depth);
  free(force);
  free(area);
  sf_table_destroy(table);
  return touched ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* 1 m ahead and 2 m up, looking along the world's x axis. */
static int show_engines(void) {
  const sf_pose X_W = {sizeof X_W, {1, 0, 2}, {1, 0, 0, 0}};
  sf_unity_pose unity = {.size = sizeof unity};
  sf_unreal_pose unreal = {.size = sizeof unreal};
  if (sf_pose_to_unity(&X_W, &unity) != SF_DONE) return EXIT_FAILURE;
  if (sf_pose_to_unreal(&X_W, &unreal) != SF_DONE) return EXIT_FAILURE;
  printf("Unity: %g %g %g m, Unreal: %g %g %g cm\n", unity.position_m[0], unity.position_m[1],
         unity.position_m[2], unreal.position_cm[0], unreal.position_cm[1], unreal.position_cm[2]);
  return EXIT_SUCCESS;
}

int main(int count, char **words) {
  if (count != 2) {
    fprintf(stderr, "usage: press FINGER\n");
    return EXIT_FAILURE;
  }
  return press(words[1]) == EXIT_SUCCESS ? show_engines() : EXIT_FAILURE;
}
