#include "softfinger/softfinger.h"

uint32_t sf_version(void) {
  return SOFTFINGER_VERSION_MAJOR * 65536u + SOFTFINGER_VERSION_MINOR * 256u +
         SOFTFINGER_VERSION_PATCH;
}

const char* sf_status_text(sf_status status) {
  switch (status) {
    case SF_DONE:
      return "done";
    case SF_FAILED:
      return "failed";
    case SF_BAD_INPUT:
      return "bad input";
  }
  return "unknown status";
}
