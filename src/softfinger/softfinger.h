/* softfinger from C99, and from whatever calls C: a soft finger explores a scene, a device answers.
 *
 *   sf_rendering *rendering = NULL;
 *   char error[256];
 *   if (sf_rendering_create("scenes/sphere.toml", NULL, &rendering, error, sizeof error) != SF_DONE)
 *     return puts(error), 1;
 *   sf_pose X_WFt = {sizeof X_WFt, {0, 0, 0.03}, {1, 0, 0, 0}};
 *   sf_command command = {sizeof command};
 *   sf_rendering_step(rendering, &X_WFt, seconds, &command);
 *
 * SI units and radians throughout. Frames: W world, right-handed, z up; F finger, its origin the
 * centre of the distal phalanx, x out of the fingertip, y to the left seen from above the nail, z
 * out of the nail; Ft the tracked finger; O an object. X_WF is the pose of F in W.
 *
 * - Every struct begins with its size, which the caller sets to sizeof; nothing is written beyond
 *   it. Fields may follow at the end of a struct in later versions, and none is taken away.
 * - A call returns SF_DONE, SF_FAILED where the work itself failed, or SF_BAD_INPUT where what it
 *   was given is wrong. What is told in `error` is one line, cut to error_size (0 and NULL: not
 *   wanted); calls on a handle leave theirs to sf_rendering_message().
 * - A handle is one thread's at a time: a second one inside a call is refused. Handles know nothing
 *   of each other. sf_rendering_stop() alone may be called from anywhere, signal handlers too.
 * - After sf_rendering_destroy() calls on the handle are refused, as are those on NULL.
 * - Arrays are copied out: at most `capacity` elements are written, and *count (may be NULL) says
 *   how many there are. Texts likewise, with their terminating zero, in bytes.
 * - Steps allocate nothing after the first that simulates. The same calls give the same bits.
 */
#ifndef SOFTFINGER_SOFTFINGER_H
#define SOFTFINGER_SOFTFINGER_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define SF_API __attribute__((visibility("default")))
#else
#define SF_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum { SF_DONE = 0, SF_FAILED = 1, SF_BAD_INPUT = 2 } sf_status;

/* What a device does; sf_command.state. */
typedef enum {
  SF_DISCONNECTED, /* its port is not open; attempts to open it go on */
  SF_HOMING,       /* moves to where it is wanted for the first time, or again after a gap */
  SF_READY,        /* follows, nothing is touched */
  SF_RENDERING,    /* follows, something is touched */
  SF_HOLDING,      /* tracking is lost for less than 200 ms: keeps its last pose */
  SF_RETRACTING,   /* moves to the retracted pose, or is there */
  SF_STOPPED       /* no command follows */
} sf_state;

typedef struct sf_rendering sf_rendering; /* a finger of a scene with its device, or all of them */

/* How a rendering is made; NULL or zeros: all defaults. */
typedef struct {
  uint32_t size;
  const char *finger;      /* name of a finger of the scene; NULL: the first */
  const char *device;      /* device file instead of the scene's; NULL: the scene's; with all_fingers
                              "NAME=FILE" */
  int32_t open_device;     /* 1: commands are sent, by softfinger-guard, a process of its own: whatever
                              becomes of this one, the device is retracted. 0: they are only formed */
  int32_t unused;
  const char *guard_program; /* NULL: beside the library, in ../bin, or where softfinger is installed */
  const char *person;        /* person file: sizes of the fingers; NULL: the finger files' */
  const char *recording;     /* records to this file, which must not exist yet; NULL: does not */
  int32_t record_state;      /* 1: nodes and samples of every step as well */
  int32_t filter;            /* 1: poses are smoothed by the one-euro filter */
  double predict_s;          /* poses are carried on by this much, 0 to 0.05 */
  int32_t all_fingers;       /* 1: all fingers of the scene, in its order, whatever `finger` says: they
                                touch the same objects, and can hold them; see sf_rendering_step_fingers() */
  int32_t threads;           /* that step several fingers side by side, 1 to 256; 0: one */
} sf_options;

/* A rigid transform. */
typedef struct {
  uint32_t size;
  double position_m[3];
  double quaternion_wxyz[4]; /* its norm is 1 within 1e-3; it is normalised */
} sf_pose;

/* What the device is told. Zero beyond the counts; all zero where there is no device. */
typedef struct {
  uint32_t size;
  uint32_t configuration_count;
  uint32_t joint_count;
  int32_t state;        /* an sf_state */
  int64_t tick;         /* counts the device's ticks from 0; -1 before the first */
  double time_s;        /* of that tick, on the caller's clock */
  double deviation_m2;  /* contact surface deviation E of the match; 0 where nothing is touched */
  double configuration[256]; /* q in the device's order; rad and m */
  double joints[256];        /* of q; rad, or m where they are linear */
  int32_t stopped;           /* sf_rendering_stop() or somebody else stopped it */
  int32_t stop_confirmed;    /* and it is a fact: who leads the servos has led them away */
  uint32_t stops;            /* how often it was stopped so far */
  uint32_t set_point_count;
  double set_points[256]; /* one a servo, as its bus has it: a pulse width in s, or ticks, or a share */
} sf_command;

/* Sums of the finger's contact; forces are those on the finger, in F. */
typedef struct {
  uint32_t size;
  uint32_t samples_in_contact;
  double time_s;             /* end of the last step, on the caller's clock */
  double normal_force_N;     /* magnitude of the vector sum of the normal forces */
  double tangential_force_N; /* likewise */
  double contact_area_m2;
  double centroid_F_m[3]; /* weighted by force */
  double mean_normal_F[3];
  double normal_force_sum_N; /* sum of the magnitudes */
  double slip_ratio;         /* 0 nothing pulls, 1 all that touches slides one way */
} sf_contact;

/* What does not change over the life of a rendering. */
typedef struct {
  uint32_t size;
  uint32_t sample_count;   /* of the skin */
  uint32_t triangle_count; /* of the skin */
  uint32_t object_count;
  uint32_t configuration_count; /* 0: no device */
  uint32_t joint_count;
  double simulation_rate_Hz;
  double device_rate_Hz; /* 0: no device */
  uint32_t finger_count;
  uint32_t unused;
} sf_info;

/* An object after the last step. */
typedef struct {
  uint32_t size;
  int32_t moves;     /* 1: by the forces on it, as a whole or in part; else what follows is 0 */
  int32_t has_joint; /* 1: a slider or hinge */
  int32_t soft;      /* 1: see sf_rendering_object_positions() */
  double joint;                      /* m, or rad; 0 without one */
  double velocity_m_per_s[3];        /* of its centre of mass, in W */
  double angular_velocity_rad_per_s[3];
} sf_object;

/* What happened to an object that moves. */
typedef enum {
  SF_NO_EVENT,
  SF_IMPACT,  /* two that did not touch for 20 ms begin to; impulse of the normal force over 10 ms */
  SF_RELEASE, /* they have not touched for 20 ms */
  SF_CLICK,   /* a slider passes the top of its force curve inwards, or its valley outwards */
  SF_DETENT,  /* the nearest rest position of a knob is another */
  SF_LIMIT    /* a joint meets its limit after 20 ms away from it */
} sf_event_kind;
typedef struct {
  uint32_t size;
  int32_t kind;         /* an sf_event_kind */
  double time_s;        /* on the caller's clock */
  double impulse_N_s;   /* NaN: none */
  uint32_t object;
  int32_t other_object; /* -1: none */
  int32_t other_finger; /* -1: none */
  int32_t unused;
} sf_event;

/* major * 65536 + minor * 256 + patch */
SF_API uint32_t sf_version(void);
/* "done", "failed", "bad input"; of anything else "unknown status". */
SF_API const char *sf_status_text(sf_status status);

/* Name of a finger of a scene file by its number from 0; *count says how many there are. */
SF_API sf_status sf_scene_finger(const char *scene, size_t index, char *name, size_t capacity,
                                 size_t *count, char *error, size_t error_size);

/* The file that a word means: one of that name, else the one that comes with softfinger. what: "scene",
   "device", "finger" or "study". A word with '/' or '.' is a path and comes back as it is. */
SF_API sf_status sf_shipped_file(const char *what, const char *word, char *file, size_t capacity,
                                 size_t *count, char *error, size_t error_size);

/* Reads the scene and what it names; trackers and waypoints in it are ignored. One finger touches the
   objects alone; with sf_options.all_fingers they touch the same. */
SF_API sf_status sf_rendering_create(const char *scene, const sf_options *options,
                                     sf_rendering **out, char *error, size_t error_size);
/* Retracts the device, which may take a second, and ends the handle. A call that another thread is
   in is finished first. */
SF_API void sf_rendering_destroy(sf_rendering *rendering);
/* What was wrong with the last call that was not SF_DONE, one line. */
SF_API sf_status sf_rendering_message(const sf_rendering *rendering, char *text, size_t capacity);

/* Simulates up to time_s, on any clock that does not go back; the first call says where it begins
   and places the finger. Between calls the pose moves straight; a gap of more than a second is
   skipped. A pose that is none (not within 1000 m, no unit quaternion) is taken as lost tracking and told
   as SF_BAD_INPUT; for any other SF_BAD_INPUT nothing is done. out: the newest command, or NULL. */
SF_API sf_status sf_rendering_step(sf_rendering *rendering, const sf_pose *X_WFt, double time_s,
                                   sf_command *out);
/* The same from a 4 x 4 matrix, row by row. */
SF_API sf_status sf_rendering_step_matrix(sf_rendering *rendering, const double X_WFt[16],
                                          double time_s, sf_command *out);
/* Tracking is lost: the device holds, after 200 ms it retracts. */
SF_API sf_status sf_rendering_lost(sf_rendering *rendering, double time_s, sf_command *out);
/* The same for all fingers of the scene, in its order: count poses, the first one's size that of each;
   tracked: of each 0 where tracking is lost, its pose then without meaning; NULL: all are tracked.
   With several fingers this takes the place of the calls above, but for sf_rendering_lost(): all are
   lost. A pose that is none is taken as lost tracking of that finger and told as SF_BAD_INPUT. */
SF_API sf_status sf_rendering_step_fingers(sf_rendering *rendering, const sf_pose *X_WFt,
                                           const int32_t *tracked, size_t count, double time_s);
/* From here on the calls that tell of a finger or its device tell of this one; at first of number 0. */
SF_API sf_status sf_rendering_select(sf_rendering *rendering, size_t finger);
/* The newest command of its device. */
SF_API sf_status sf_rendering_command(const sf_rendering *rendering, sf_command *out);
/* Retracts the device, with several fingers all of them, at once and until it is released, also while nobody
   steps. */
SF_API sf_status sf_rendering_stop(sf_rendering *rendering);
/* Asks to release it from the stops that the last step told of; sf_command.stopped says whether it
   is. SF_FAILED: nothing is stopped, or it was stopped again since. */
SF_API sf_status sf_rendering_release(sf_rendering *rendering);

/* The next line that a person should read of the device, each told once: what its file asks them to
   know, that its port is gone or back, that it was stopped and by whom. Empty (*count is 1): nothing
   more now. Allocates; a line that does not fit is cut. */
SF_API sf_status sf_rendering_take_message(sf_rendering *rendering, char *text, size_t capacity,
                                           size_t *count);

SF_API sf_status sf_rendering_info(const sf_rendering *rendering, sf_info *out);
SF_API sf_status sf_rendering_contact(const sf_rendering *rendering, sf_contact *out);
/* Tracked and simulated pose after the last step; either may be NULL. In contact F stays behind. */
SF_API sf_status sf_rendering_poses(const sf_rendering *rendering, sf_pose *X_WFt, sf_pose *X_WF);
/* Deformed skin: x, y, z of each sample; capacity and *count in samples. */
SF_API sf_status sf_rendering_positions(const sf_rendering *rendering, double *xyz_F_m,
                                        size_t capacity, size_t *count);
SF_API sf_status sf_rendering_pressures(const sf_rendering *rendering, double *pressures_Pa,
                                        size_t capacity, size_t *count);
/* 1 where skin around the sample touches, else 0. */
SF_API sf_status sf_rendering_in_contact(const sf_rendering *rendering, uint8_t *in_contact,
                                         size_t capacity, size_t *count);
/* Three samples a triangle, counter-clockwise from outside; capacity and *count in triangles. */
SF_API sf_status sf_rendering_triangles(const sf_rendering *rendering, uint32_t *corners,
                                        size_t capacity, size_t *count);
/* Where the object is, and its name. */
SF_API sf_status sf_rendering_object_pose(const sf_rendering *rendering, size_t object,
                                          sf_pose *X_WO);
SF_API sf_status sf_rendering_object_name(const sf_rendering *rendering, size_t object, char *name,
                                          size_t capacity, size_t *count);
SF_API sf_status sf_rendering_object(const sf_rendering *rendering, size_t object, sf_object *out);
/* The surface of something soft as it is deformed: x, y, z of each point in W; three points a
   triangle, counter-clockwise from outside. None of what keeps its shape. */
SF_API sf_status sf_rendering_object_positions(const sf_rendering *rendering, size_t object,
                                               double *xyz_W_m, size_t capacity, size_t *count);
SF_API sf_status sf_rendering_object_triangles(const sf_rendering *rendering, size_t object,
                                               uint32_t *corners, size_t capacity, size_t *count);
/* The next event, each told once; SF_NO_EVENT: nothing more now. Of more than 256 that wait the oldest
   are forgotten. */
SF_API sf_status sf_rendering_take_event(sf_rendering *rendering, sf_event *out);
/* "impact", "release", ...; of anything else "". */
SF_API const char *sf_event_text(sf_event_kind kind);
SF_API sf_status sf_rendering_finger_name(const sf_rendering *rendering, size_t finger, char *name,
                                          size_t capacity, size_t *count);
/* Name of a component of the configuration with the unit people read, e.g. pitch_deg. */
SF_API sf_status sf_rendering_configuration_name(const sf_rendering *rendering, size_t component,
                                                 char *name, size_t capacity, size_t *count);
/* Writes what is left of the recording and closes it; steps after that are not recorded. */
SF_API sf_status sf_rendering_close_recording(sf_rendering *rendering, char *error,
                                              size_t error_size);

/* Poses as game engines have them, both left-handed.
   Unity: y up, metres; x_U = -y_W, y_U = z_W, z_U = x_W.
   Unreal: z up, centimetres; x_U = 100 x_W, y_U = -100 y_W, z_U = 100 z_W.
   Axes of bodies turn with those of the world: F's tip is along z in Unity, x in Unreal. Front sides
   of triangles are counter-clockwise here, clockwise there: swap two corners of each. */
typedef struct {
  uint32_t size;
  double position_m[3];
  double quaternion_xyzw[4];
} sf_unity_pose;
typedef struct {
  uint32_t size;
  double position_cm[3];
  double quaternion_xyzw[4];
} sf_unreal_pose;
SF_API sf_status sf_pose_to_unity(const sf_pose *pose, sf_unity_pose *out);
SF_API sf_status sf_pose_from_unity(const sf_unity_pose *pose, sf_pose *out);
SF_API sf_status sf_pose_to_unreal(const sf_pose *pose, sf_unreal_pose *out);
SF_API sf_status sf_pose_from_unreal(const sf_unreal_pose *pose, sf_pose *out);

/* Results in columns, names with their units as the command line has them; a missing value is NaN.
   Reading calls are any thread's. */
typedef struct sf_table sf_table;
SF_API void sf_table_destroy(sf_table *table);
SF_API sf_status sf_table_size(const sf_table *table, size_t *rows, size_t *columns);
SF_API sf_status sf_table_name(const sf_table *table, size_t column, char *name, size_t capacity,
                               size_t *count);
SF_API sf_status sf_table_column(const sf_table *table, size_t column, double *values,
                                 size_t capacity, size_t *count);
/* All of the result as the command prints it with --json. */
SF_API sf_status sf_table_text(const sf_table *table, char *text, size_t capacity, size_t *count);

/* A finger pressed on a fixed obstacle, bone prescribed; as `softfinger press`. Zero, but for rows
   and depth_m: a plane, quasi-static, friction and strain limits as the finger file has them. */
typedef struct {
  uint32_t size;
  int32_t rows;            /* 1 to 10000; 0: 20 */
  double depth_m;          /* greatest bone displacement after first touch, at most 0.02; 0: 0.002 */
  double sphere_radius_m;  /* above 0: a sphere, at_m under F's origin */
  double at_m[2];
  int32_t edge;            /* 1: a 90-degree edge along y, rounded by edge_radius_m */
  int32_t no_strain_limits;
  double edge_radius_m;
  int32_t no_friction;
  int32_t relaxed;         /* 1: long-time moduli */
  double pitch_rad;        /* turn about the finger's y axis, distal end down */
  double speed_m_per_s;    /* above 0: stepped in time */
  double hold_s;           /* then held for so long, in as many rows again; needs a speed */
  int32_t unload;          /* 1: then back to first touch, in as many rows again */
  int32_t unused;
  const volatile int32_t *stop; /* becomes 1, by another thread or a signal handler: ends after the row
                                   under way, and the rows until then are the result; NULL: never */
  volatile double *progress; /* how far it is, of 1, written after each row; NULL: nowhere */
  const char *export_folder; /* nodes.csv, contact.csv, features.csv and patches.csv go there; NULL:
                                nowhere */
} sf_press_options;
SF_API sf_status sf_press(const char *finger, const sf_press_options *options, sf_table **out,
                          char *error, size_t error_size);

/* How faithfully a device renders a scene, judged by a second finger; as `softfinger evaluate`. NULL
   and zeros: as the scene says. */
typedef struct {
  uint32_t size;
  const char *device;    /* device file; "NAME=FILE" for one of several fingers */
  const char *wearer;    /* finger file of who wears the device; NULL: the simulated finger */
  const char *objective; /* what matching aims at, instead of the device file's */
  const char *person;    /* person file */
  double duration_s;     /* 0: until the script ends */
  const volatile int32_t *stop; /* becomes 1, by another thread or a signal handler: ends early, and
                                   what was judged until then is the result; NULL: never */
  volatile double *progress; /* how far it is, of 1, written now and then; NULL: nowhere */
  const char *tracker;       /* script or csv:FILE instead of the scene's; NAME=SPEC for one of
                                several fingers */
} sf_evaluate_options;
/* A row for each device tick of each finger, `finger` its number in the scene. */
SF_API sf_status sf_evaluate(const char *scene, const sf_evaluate_options *options, sf_table **out,
                             char *error, size_t error_size);

/* A scene until its script ends, without a page, as fast as it goes, with emulated devices; as
   `softfinger run --headless --as-fast-as-possible`. NULL and zeros: as the scene says. */
typedef struct {
  uint32_t size;
  int32_t record_state;  /* 1: all nodes and samples of every step are recorded as well */
  const char *device;    /* as for sf_evaluate() */
  const char *wearer;    /* finger file of whom an emulated force sensor is on */
  const char *person;
  const char *recording; /* new file */
  double duration_s;     /* 0: until the script ends */
  double predict_s;      /* carries tracked poses on over their age and this time more; 0: does not */
  int32_t filter;        /* 1: smooths tracked poses */
  int32_t threads;       /* that step several fingers side by side; 0: one */
  const volatile int32_t *stop; /* as for sf_evaluate(): what ran until then is the result */
  volatile double *progress;
  const char *tracker; /* as for sf_evaluate(), and those that stream poses (docs/trackers.md) */
} sf_run_options;
/* sf_table_text() is what `softfinger run --json` prints; there are no columns. */
SF_API sf_status sf_run(const char *scene, const sf_run_options *options, sf_table **out,
                        char *error, size_t error_size);

/* Young's modulus and strain limits of a finger file from a press that was measured on a flat plate;
   as `softfinger finger fit`. NULL and zeros: as the command does. */
typedef struct {
  uint32_t size;
  int32_t noise;         /* of the forces: 0 the likelier, 1 in proportion to them, 2 alike for all */
  const char *areas;     /* CSV file: force_N,area_mm2 */
  const char *out;       /* new finger file; NULL: none is written */
  const char *parameters; /* of "youngs_modulus_kPa,min,max" these alone; NULL: all that the data
                             tell */
  double pitch_rad;      /* of the finger, distal end down */
  const volatile int32_t *stop; /* becomes 1: ends after the press under way, SF_FAILED, and nothing
                                   is written; NULL: never */
} sf_fit_options;
/* curve: CSV file indentation_mm,force_N. sf_table_text() is what the command's --json prints. */
SF_API sf_status sf_finger_fit(const char *finger, const char *curve, const sf_fit_options *options,
                               sf_table **out, char *error, size_t error_size);

/* A recording for other programs, as `softfinger export`: to FILE.h5, FILE.mcap, else CSV files in a
   new folder. note: a line where it was cut or lacks something, else empty. */
SF_API sf_status sf_recording_export(const char *recording, const char *to, char *note,
                                     size_t capacity, char *error, size_t error_size);
/* Runs it again with its recorded input: *agree is 1 where every bit is the same, else 0 and
   difference says where. */
SF_API sf_status sf_recording_replay(const char *recording, int32_t *agree, char *difference,
                                     size_t capacity, char *error, size_t error_size);

/* What a device file describes. Immutable: reading calls are any thread's. */
typedef struct sf_device sf_device;
SF_API sf_status sf_device_create(const char *file, sf_device **out, char *error,
                                  size_t error_size);
SF_API void sf_device_destroy(sf_device *device);
typedef struct {
  uint32_t size;
  uint32_t configuration_count;
  uint32_t joint_count;
  int32_t joints_are_linear; /* 1: m, else rad */
} sf_device_info;
SF_API sf_status sf_device_describe(const sf_device *device, sf_device_info *out);
/* The file's keys with defaults filled in, as JSON. */
SF_API sf_status sf_device_show(const sf_device *device, char *text, size_t capacity,
                                size_t *count);
/* Name of a component of the configuration with the unit people read; *unit is that in SI. */
SF_API sf_status sf_device_component(const sf_device *device, size_t component, char *name,
                                     size_t capacity, double *unit);
SF_API sf_status sf_device_home(const sf_device *device, double *configuration, size_t count);
/* Joints of a configuration. *closes is 0, and the joints NaN, where the linkage does not close;
   *reachable is 1 within the workspace. Counts must be the device's. */
SF_API sf_status sf_device_solve(const sf_device *device, const double *configuration,
                                 size_t configuration_count, double *joints, size_t joint_count,
                                 int32_t *closes, int32_t *reachable);
/* Configuration of joints. SF_FAILED: none within the workspace has them. */
SF_API sf_status sf_device_pose(const sf_device *device, const double *joints, size_t joint_count,
                                double *configuration, size_t configuration_count);

/* Skin as matching sees it. */
typedef struct {
  uint32_t size;
  uint32_t count;             /* of samples, 1 to 100000 */
  const double *points_F_m;   /* x, y, z of each */
  const uint8_t *in_contact;  /* 1: touches */
  const double *areas_m2;     /* NULL: all alike; else weights by area */
  const double *gaps_m;       /* virtual gaps; NULL: the separation is constant */
  double separation_m;        /* separation tolerance eps; 0: the device's */
  int32_t limits;             /* 0: inside, 1: clamp, 2: none */
  int32_t objective;          /* 0: surface, 1: published (limits clamp or none, no gaps), 2: plane */
} sf_points;
typedef struct {
  uint32_t size;
  uint32_t configuration_count;
  uint32_t joint_count;
  int32_t joints_exist;
  int32_t iterations;
  int32_t termination; /* 0: converged, 1: iteration limit, 2: nonsmooth */
  double deviation_m2; /* contact surface deviation E */
  double configuration[256];
  double joints[256];
  char at_limit[1024]; /* names of joints and components that stand at a limit, "joint_1,travel_mm";
                          empty: none; cut to what fits */
} sf_match;
/* The configuration whose surface touches the samples in contact and no others. */
SF_API sf_status sf_device_match(const sf_device *device, const sf_points *points, sf_match *out);
/* What was wrong with the last call on the device that was not SF_DONE, one line. */
SF_API sf_status sf_device_message(const sf_device *device, char *text, size_t capacity);

/* How far the device goes within all limits; as `softfinger device workspace --json`. */
SF_API sf_status sf_device_workspace(const sf_device *device, char *text, size_t capacity,
                                     size_t *count);

/* The host has an object where it is: X_WO at the time of the next call that simulates, until when it
   moves straight; it stays where it was put last, whatever its file says; before the first call it
   is there from the start. Refused of what moves by forces or has something hang on it by a joint,
   of a pose that is none, and while a recording is made, which could not be replayed. */
SF_API sf_status sf_rendering_move_object(sf_rendering *rendering, size_t object,
                                          const sf_pose *X_WO);

/* More of tables: the unit of a column's numbers, "mm", "deg/s"; "1" of a pure number; empty where it
   has words. Those have numbers from 0 for values, which sf_table_word() turns into words. */
SF_API sf_status sf_table_unit(const sf_table *table, size_t column, char *unit, size_t capacity,
                               size_t *count);
SF_API sf_status sf_table_word(const sf_table *table, size_t column, size_t number, char *word,
                               size_t capacity, size_t *count);

/* What a long call and its host see of each other; NULL: nothing. */
typedef struct {
  uint32_t size;
  int32_t unused;
  const volatile int32_t *stop; /* becomes 1, by another thread or a signal handler: ends soon,
                                   SF_FAILED, and nothing half done stays; NULL: never */
  volatile double *progress;    /* how far it is, of 1, written now and then; NULL: nowhere */
} sf_watch;

/* A table of a recording in columns, as `softfinger export` has them, with all digits: "pose", "contact",
   "objects", ...; which there are stands in sf_table_text(), an object with `tables`, and `note`, a
   line where the recording was cut, else empty. table NULL: no columns, the text alone. */
SF_API sf_status sf_recording_table(const char *recording, const char *table, const sf_watch *watch,
                                    sf_table **out, char *error, size_t error_size);
/* sf_recording_export(), watched. */
SF_API sf_status sf_export(const char *recording, const char *to, const sf_watch *watch, char *note,
                           size_t capacity, char *error, size_t error_size);
/* sf_recording_replay(), watched; sf_table_text() is what `softfinger replay --json` prints. NULL and
   zeros: as recorded. */
typedef struct {
  uint32_t size;
  int32_t unused;
  const char *scene;  /* runs this one with the recorded input */
  const char *person; /* person file */
  const volatile int32_t *stop; /* as of sf_watch */
  volatile double *progress;
} sf_replay_options;
SF_API sf_status sf_replay(const char *recording, const sf_replay_options *options, sf_table **out,
                           char *error, size_t error_size);

/* What files say, as `softfinger scene check` and `finger show` print it with --json: sf_table_text();
   there are no columns. */
SF_API sf_status sf_scene_check(const char *scene, const sf_watch *watch, sf_table **out, char *error,
                                size_t error_size);
SF_API sf_status sf_finger_show(const char *finger, sf_table **out, char *error, size_t error_size);
/* JSON Schema of files. what: "scene", "finger", "person" or "device"; kind: of device, NULL: all. */
SF_API sf_status sf_schema(const char *what, const char *kind, sf_table **out, char *error,
                           size_t error_size);

/* A person's finger: its size, and where a tracked body sits on it; as `softfinger finger register`.
   NULL and zeros: not given. */
typedef struct {
  uint32_t size;
  int32_t table_given; /* 1: table_m is the height of the table in W; else it is found */
  const char *finger;  /* whose tables are written; NULL: "index" */
  const char *scene;   /* whose finger it is, where its name is none of a hand's */
  const char *tracker; /* of the body on the finger, which is held in five postures on a table: pad,
                          left side, right side, tip, pad, each until it was still for a second;
                          NULL: the sizes alone are written */
  const char *model;   /* finger file whose shape is fitted; needed with a tracker */
  double length_m, breadth_m, depth_m; /* of the fingertip, measured; 0: not */
  double table_m;
  const volatile int32_t *stop; /* as of sf_watch */
  volatile double *progress;    /* postures held, of 1 */
} sf_register_options;
/* person: file to write or change. */
SF_API sf_status sf_finger_register(const char *person, const sf_register_options *options,
                                    sf_table **out, char *error, size_t error_size);

/* A device presses its wearer by itself and learns what finger it sits on; as `softfinger device fit`.
   NULL and zeros: as the command does. Its port is softfinger-guard's; a stop, and every failure,
   retracts it first. */
typedef struct {
  uint32_t size;
  int32_t again;      /* 1: the finger is known, the device was put on again: mount alone */
  const char *name;   /* of the finger in the person's file; NULL: "index" */
  const char *wearer; /* finger file of whom an emulated device is on; NULL: the finger's */
  const char *sensor; /* an emulated force sensor for a device file without: emulator, udp, osc, serial */
  const char *fault;  /* of an emulated sensor, to see what is made of it: dead, stuck, reversed, ... */
  double fault_at_s;
  double sensor_noise_N; /* of an emulated sensor, where sensor_noise_given is 1 */
  int32_t sensor_noise_given;
  int32_t real_time;  /* 1: an emulated device too goes by the clock, through port and guard process */
  uint64_t seed;      /* of that noise; 0: 1 */
  const char *guard_program; /* as in sf_options */
  const volatile int32_t *stop; /* as of sf_watch */
  volatile double *progress;
  int32_t by_touch; /* 1: without a force sensor, from touches that the wearer tells */
  int32_t unused;
  const volatile int32_t *touches; /* by touch, of a device with motors: counted up at each touch that
                                      the wearer tells; NULL: none are. An emulated wearer tells by
                                      itself */
} sf_device_fit_options;
/* person: file to write or change. SF_FAILED, and nothing written, where the presses do not foretell
   each other or the sensor is no good; *out is then NULL. */
SF_API sf_status sf_device_fit(const char *device, const char *finger, const char *person,
                               const sf_device_fit_options *options, sf_table **out, char *error,
                               size_t error_size);

/* Servos of a device from what was seen of each joint, which is moved slowly, in turn; as `softfinger
   device calibrate --at --moved`. Numbers are in degrees, or mm where joints are lengths. */
typedef struct {
  uint32_t size;
  uint32_t count;      /* of numbers in each array: the device's servos */
  const double *at;    /* where each stands at home */
  const double *moved; /* by how many each moved */
  const char *port;    /* instead of the device file's; NULL: that */
  const volatile int32_t *stop; /* as of sf_watch; the device retracts first */
} sf_calibrate_options;
/* to: new file for [transport]. note: a line a joint, what it reaches. */
SF_API sf_status sf_device_calibrate(const char *device, const char *to,
                                     const sf_calibrate_options *options, char *note, size_t capacity,
                                     char *error, size_t error_size);

/* What smoothing and prediction would make of a known motion that a tracking system sees; as `softfinger
   condition`. One of filter and predict_s must be given. */
typedef struct {
  uint32_t size;
  int32_t filter;     /* 1: poses are smoothed */
  const char *finger; /* of a recording of several; NULL: the first */
  double rate_Hz;     /* poses a second that the tracker sees; 0: 120 */
  double age_s;       /* of a pose when it arrives */
  double noise_m;     /* standard deviation of each coordinate */
  double noise_rad;   /* and about each axis */
  double predict_s;   /* poses are carried on over their age and so much more */
  int32_t predict;    /* 1: predict_s is given */
  int32_t unused;
} sf_condition_options;
/* motion: a recording, or a CSV file of poses. */
SF_API sf_status sf_condition(const char *motion, const sf_condition_options *options, sf_table **out,
                              char *error, size_t error_size);

/* Many designs, worn by many people; as `softfinger study`. A folder goes on with what is in it. */
typedef struct {
  uint32_t size;
  int32_t unused;
  uint32_t shard;  /* from 1: this one of `shards` equal parts, all into one folder; 0: all of it */
  uint32_t shards;
  const volatile int32_t *stop; /* as of sf_watch; what is recorded stays, and is gone on from */
  volatile double *progress;
} sf_study_options;
/* sf_table_text(): end (finished, shard done, awaits other shards), designs, infeasible, cases, done,
   recorded (of those, before this call), first_reason, messages. */
SF_API sf_status sf_study_run(const char *study, const char *folder, const sf_study_options *options,
                              sf_table **out, char *error, size_t error_size);
/* A row a design as `softfinger study export` has them, also while the study goes on. sf_table_text():
   study, kind, device, parameters, objectives, constraints, finished. */
SF_API sf_status sf_study_table(const char *folder, sf_table **out, char *error, size_t error_size);
/* To a new FILE.csv; of contacts FILE.h5. note: a line where the study is not finished. */
SF_API sf_status sf_study_export(const char *folder, const char *to, char *note, size_t capacity,
                                 char *error, size_t error_size);
/* The device file of a design, by its number in the table, to a new file. */
SF_API sf_status sf_study_device(const char *folder, int64_t design, const char *to, char *error,
                                 size_t error_size);
/* report.html and its plots as SVG files into a folder, made if absent. */
SF_API sf_status sf_study_plot(const char *folder, const char *to, char *error, size_t error_size);

#ifdef __cplusplus
}
#endif
#endif
