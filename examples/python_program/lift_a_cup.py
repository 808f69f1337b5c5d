"""Index and thumb lift a cup by friction alone: all fingers of a scene in one rendering.

    lift_a_cup.py SCENE        e.g. scenes/cup.toml
"""

import sys

import numpy as np
import softfinger

HALF = np.sqrt(0.5)
LIFT = 0.03  # m


def poses(seconds: float) -> list[np.ndarray]:
    """Index and thumb, m and a quaternion: they close on the cup within a second, then rise."""
    x = 0.046 - 0.012 * min(seconds, 1.0)
    z = 0.052 + LIFT * np.clip(seconds - 1.2, 0.0, 1.0)
    return [np.array([x, 0.0, z, HALF, 0.0, HALF, 0.0]), np.array([-x, 0.0, z, 0.0, HALF, 0.0, -HALF])]


def main() -> None:
    with softfinger.Rendering(sys.argv[1], all_fingers=True) as rendering:
        for step in range(2400):
            seconds = step / rendering.simulation_rate
            rendering.step_all(poses(seconds), seconds)
            for event in rendering.events():
                print(f"{event.time:.3f} s: {event.kind}: {event.object} and {event.other}")
        cup = rendering.object(0)
        forces = ", ".join(f"{finger.name} {finger.snapshot().normal_force:.2f} N" for finger in rendering.fingers)
    rise = 1e3 * (cup.X_WO[2, 3] - 0.04)
    print(f"The {cup.name} rose by {rise:.1f} mm between {forces}.")
    if abs(rise - 1e3 * LIFT) > 2:
        sys.exit("It slipped.")


if __name__ == "__main__":
    main()
