"""Drives a device by the poses of one's own tracker, a line each on standard input: time_s x_mm y_mm z_mm qw qx qy qz.

    own_tracker.py SCENE DEVICE [--open] < poses

--open sends commands to the device's motors; without it they are only computed. Ctrl-C, the end of the input and a
tracker that falls silent lead the device away from the finger.
"""

import queue
import sys
import threading

import numpy as np
import softfinger

SILENCE = 0.1  # s


def lines():
    """Of standard input; None where none comes for a while."""
    come = queue.SimpleQueue()
    threading.Thread(target=lambda: [come.put(line) for line in sys.stdin] + [come.put("")], daemon=True).start()
    while True:
        try:
            if not (line := come.get(timeout=SILENCE)):
                return
            yield line
        except queue.Empty:
            yield None


def parsed(line: str) -> list[float]:
    numbers = [float(word) for word in line.split()]
    if len(numbers) != 8:
        raise ValueError(f"a line has {len(numbers)} numbers: must be 8")
    return numbers


def main(scene: str, device: str, open_device: bool) -> None:
    time = 0.0
    with softfinger.Rendering(scene, device=device, open_device=open_device) as rendering:
        for message in rendering.messages():
            print(message, file=sys.stderr)
        for line in lines():
            if line is None:
                time += SILENCE
                command = rendering.lost(time)
            else:
                time, *pose = parsed(line)
                command = rendering.step(softfinger.matrix_of(1e-3 * np.array(pose[:3]), np.array(pose[3:])), time)
            print(f"{time:.3f} s  {command.state:<10} {rendering.snapshot().normal_force:.3f} N", *np.round(command.joints, 4))


if __name__ == "__main__":
    words = [word for word in sys.argv[1:] if word != "--open"]
    if len(words) != 2:
        sys.exit("usage: own_tracker.py SCENE DEVICE [--open] < poses")
    try:
        main(*words, "--open" in sys.argv)
    except KeyboardInterrupt:
        pass
    except (ValueError, softfinger.OperationError) as error:  # InputError is one
        sys.exit(f"own_tracker.py: {error}")
