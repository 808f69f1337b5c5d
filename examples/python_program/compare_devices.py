"""Which of these devices renders a scene better, and how stiff the finger pad is that they touch.

    compare_devices.py SCENE FINGER DEVICE...
"""

import sys

import softfinger


def main(scene: str, finger: str, *devices: str) -> None:
    curve = softfinger.press(finger, to_mm=1.0, steps=5)
    print("pressed by", *(f"{depth:.1f}" for depth in curve["indentation_mm"]), "mm:",
          *(f"{force:.2f}" for force in curve["normal_force_N"]), "N")
    for file in devices:
        device = softfinger.Device(file)
        judged = softfinger.evaluate(scene, device=file, duration_s=2.0)
        touching = judged.frames["virtual_force_N"] > 0.0
        print(f"{file}: moves {', '.join(device.names)}; {touching.sum()} of {len(touching)} frames touch")
        for name in ("iou", "normal_force_error"):
            mean = judged.mean[name]
            print(f"  {name:<20} {'-' if mean is None else format(mean, '.3f')}")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit("usage: compare_devices.py SCENE FINGER DEVICE...")
    try:
        main(*sys.argv[1:])
    except (softfinger.InputError, softfinger.OperationError) as error:
        sys.exit(f"compare_devices.py: {error}")
