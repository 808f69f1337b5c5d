#include "softfinger/actuation/guard_process.hpp"

// Started by softfinger, which hands it a device's port to own; of no use by itself.
int main() { return softfinger::serve_guarded_line(); }
