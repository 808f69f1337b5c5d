"""What a step costs more through Python: CPU time of calls at one time, which simulate nothing, us.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/python_step.py [SCENE] [--json]
"""

import json
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


def main(scene, as_json):
    X_WFt, pose = np.eye(4), np.array([0.0, 0.0, 0.026, 1.0, 0.0, 0.0, 0.0])
    X_WFt[2, 3] = 0.026
    with softfinger.Rendering(scene) as rendering:
        for i in range(500):
            rendering.step(X_WFt, 1e-3 * i)
        costs = {"matrix_us": cost(lambda: rendering.step(X_WFt, 0.499)), "pose_us": cost(lambda: rendering.step(pose, 0.499)),
                 "snapshot_us": cost(rendering.snapshot, 500)}
    if as_json:
        print(json.dumps(costs))
        return
    print("Python, CPU time of a call, us:")
    for name, key in (("step, (4, 4) matrix", "matrix_us"), ("step, (7,) pose", "pose_us"), ("snapshot", "snapshot_us")):
        print(f"  {name:<22} {costs[key]:6.2f}")


words = [word for word in sys.argv[1:] if word != "--json"]
main(words[0] if words else "scenes/sphere.toml", "--json" in sys.argv)
