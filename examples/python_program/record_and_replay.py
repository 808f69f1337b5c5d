"""Runs a scene, records it, looks at what was recorded, and runs it again to the bit.

    record_and_replay.py SCENE
"""

import pathlib
import sys
import tempfile

import softfinger


def main(scene: str) -> int:
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "run.sqlite")
        report = softfinger.run(scene, record=file, record_state=True, duration_s=1.5)
        recording = softfinger.Recording(file)
        steps, ticks = recording.steps, recording.ticks
        deepest = steps["normal_force_N"].argmax()
        print(f"{report['steps']} steps; most force {steps['normal_force_N'][deepest]:.2f} N at {steps['time_s'][deepest]:.3f} s")
        print(f"{len(ticks['time_s'])} device ticks, states {', '.join(sorted(set(ticks['state'])))}")
        skin = recording.table("samples")
        touching = skin["in_contact"] > 0
        print(f"{len(skin['time_s'])} rows of skin, {touching.sum()} of them touch, nearest {1e3 * skin['gap_mm'].min():.0f} um")
        difference = recording.replay()
        print("replayed: every bit the same" if not difference else f"replayed: {difference}")
        return 0 if touching.any() and not difference else 1


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: record_and_replay.py SCENE")
    try:
        sys.exit(main(sys.argv[1]))
    except (softfinger.InputError, softfinger.OperationError) as error:
        sys.exit(f"record_and_replay.py: {error}")
