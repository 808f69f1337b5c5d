"""A finger goes down onto what lies under it; contact and the device's answer, ten times a second.

    touch.py SCENE

Here the pose is made up: put your tracker's in its place.
"""

import sys

import numpy as np
import softfinger


def main(scene: str) -> int:
    most_force = 0.0
    with softfinger.Rendering(scene) as rendering:
        for i in range(1001):
            time = 1e-3 * i  # s; a live program takes its clock
            X_WFt = np.eye(4)
            X_WFt[2, 3] = 30e-3 - 6e-3 * time  # 30 mm above the origin, then down at 6 mm/s
            command = rendering.step(X_WFt, time)
            if i % 100 == 0:
                finger = rendering.snapshot()
                joints = " ".join(f"{joint:6.3f}" for joint in command.joints)
                print(f"{time:.1f} s  {finger.normal_force:6.3f} N  {1e6 * finger.contact_area:5.1f} mm2  joints {joints} rad")
                most_force = max(most_force, finger.normal_force)
    return 0 if most_force > 0.0 else 1


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: touch.py SCENE")
    try:
        sys.exit(main(sys.argv[1]))
    except (softfinger.InputError, softfinger.OperationError) as error:
        sys.exit(f"touch.py: {error}")
