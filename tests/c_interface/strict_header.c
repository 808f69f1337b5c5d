/* The header alone, as the strictest C compiler takes it. */
#include "softfinger/softfinger.h"

/* What was published once stays where it was. */
typedef char command_begins_as_before[offsetof(sf_command, configuration) == 40 &&
                                              offsetof(sf_command, stopped) == 40 + 2 * 256 * 8
                                          ? 1
                                          : -1];
typedef char options_begin_as_before[offsetof(sf_options, open_device) == 3 * sizeof(void *) ? 1 : -1];
typedef char contact_begins_as_before[offsetof(sf_contact, normal_force_sum_N) == 88 ? 1 : -1];
typedef char pose_is_as_before[sizeof(sf_pose) == 64 ? 1 : -1];
