"""What a step costs more through Python: CPU time of calls at one time, which simulate nothing, us.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/python_step.py [SCENE]
"""

import statistics
import sys
import time

import numpy as np
import softfinger


def cost(call, times=2000):
    """Median over rounds of the mean CPU time of a call, us."""
    rounds = []
    for _ in range(15):
        start = time.thread_time()
        for _ in range(times):
            call()
        rounds.append((time.thread_time() - start) / times * 1e6)
    return statistics.median(rounds)


def main(scene):
    X_WFt, pose = np.eye(4), np.array([0.0, 0.0, 0.026, 1.0, 0.0, 0.0, 0.0])
    X_WFt[2, 3] = 0.026
    with softfinger.Rendering(scene) as rendering:
        for i in range(500):
            rendering.step(X_WFt, 1e-3 * i)
        print(f"step, (4, 4) matrix    {cost(lambda: rendering.step(X_WFt, 0.499)):6.2f} us")
        print(f"step, (7,) pose        {cost(lambda: rendering.step(pose, 0.499)):6.2f} us")
        print(f"snapshot               {cost(rendering.snapshot, 500):6.2f} us")


main(sys.argv[1] if len(sys.argv) > 1 else "scenes/sphere.toml")
