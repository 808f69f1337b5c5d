"""Who wears it: a person's fingers, measured, registered, pressed by a device that learns them; and servos as they are."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _library
from ._library import library
from ._long_work import Watch
from ._tables import report_of
from .rendering import Path

#: That register_finger() asks for, in their order.
POSTURES = ("pad", "left side", "right side", "tip", "pad")


def register_finger(
    person: Path,
    *,
    finger: str = "index",
    scene: Path | None = None,
    length_mm: float | None = None,
    breadth_mm: float | None = None,
    depth_mm: float | None = None,
    tracker: str | None = None,
    model: Path | None = None,
    table_mm: float | None = None,
    ask: Callable[[str], None] = print,
) -> dict[str, Any]:
    """A finger's size, and where a tracked body sits on it, into a person file; as `softfinger finger register`.

    person: file to write or change. finger: whose tables are written. scene: whose finger it is, where its
    name is none of a hand's. length_mm, breadth_mm, depth_mm: of the fingertip, measured; alone they are
    what is written. tracker: of the body on the finger, which is held on a table in the five POSTURES, each
    until it was still for a second; needs model, the finger file whose shape is fitted. table_mm: height of
    the table in the world; without sizes the finger's is then found. ask: told which posture is next.

    Returns what the command prints with --json: sizes, translation_mm and rotation_vector_deg of X_BodyFt,
    table_height_mm, residuals. Ctrl-C ends it, and writes nothing.
    """
    watch = Watch()
    asked: list[int] = []

    def tell(done: float) -> None:
        at = min(int(done * len(POSTURES) + 1e-9), len(POSTURES) - 1)
        if at not in asked:
            asked.append(at)
            ask(f"{at + 1} of {len(POSTURES)}: hold the {POSTURES[at]} on the table, and still")

    if tracker is not None:
        watch.tell = tell
    options = _library.RegisterOptions(
        size=ctypes.sizeof(_library.RegisterOptions), table_given=table_mm is not None,
        finger=_library.text(finger, "finger"), scene=_library.path(scene), tracker=_library.text(tracker, "tracker"),
        model=_library.path(model), length_m=_metres(length_mm), breadth_m=_metres(breadth_mm), depth_m=_metres(depth_mm),
        table_m=1e-3 * (table_mm or 0.0), stop=watch.stop, progress=watch.progress)
    name = _library.path(person)
    return report_of(watch, "register", lambda *out: int(library.sf_finger_register(name, ctypes.byref(options), *out)))


def fit_device(
    device: Path,
    finger: Path,
    person: Path,
    *,
    name: str = "index",
    wearer: Path | None = None,
    sensor: str | None = None,
    sensor_noise_N: float | None = None,
    seed: int = 1,
    again: bool = False,
    by_touch: bool = False,
    touches: ctypes.c_int32 | None = None,
    real_time: bool = False,
    fault: str | None = None,
    fault_at_s: float = 0.0,
    guard_program: Path | None = None,
) -> dict[str, Any]:
    """A device presses its wearer by itself and learns what finger it sits on; as `softfinger device fit`.

    finger: file whose shape and skin are fitted. person: file to write or change, of it the finger `name`.
    wearer: finger file of whom an emulated device is on. sensor, sensor_noise_N, seed: an emulated force
    sensor for a device file without, its noise. again: the finger is known, the device was put on again:
    mount alone. by_touch: without a force sensor, from touches that the wearer tells; of a device with motors
    by counting up touches.value from another thread, an emulated wearer tells by itself. real_time: an emulated
    device too goes by the clock. fault, fault_at_s: of an emulated sensor, to see what is made of it.
    guard_program: softfinger-guard, where it is not with the library.

    Returns what the command prints with --json: parameters by name with value, ci95_low, ci95_high and prior,
    predicted_force_error, ... Raises OperationError, and writes nothing, where the presses do not foretell
    each other or the sensor is no good. Ctrl-C retracts the device first.
    """
    watch = Watch()
    options = _library.DeviceFitOptions(
        size=ctypes.sizeof(_library.DeviceFitOptions), again=again, name=_library.text(name, "name"),
        wearer=_library.path(wearer), sensor=_library.text(sensor, "sensor"), fault=_library.text(fault, "fault"),
        fault_at_s=fault_at_s, sensor_noise_N=sensor_noise_N or 0.0, sensor_noise_given=sensor_noise_N is not None,
        real_time=real_time, seed=seed, guard_program=_library.path(guard_program), stop=watch.stop,
        progress=watch.progress, by_touch=by_touch,
        touches=None if touches is None else ctypes.pointer(touches))
    files = _library.path(device), _library.path(finger), _library.path(person)
    return report_of(watch, "fit", lambda *out: int(library.sf_device_fit(*files, ctypes.byref(options), *out)))


def calibrate_device(
    device: Path, to: Path, *, at: ArrayLike, moved: ArrayLike, port: str | None = None
) -> list[str]:
    """Servos from what was seen of each joint, which is moved slowly, in turn; as `softfinger device calibrate`.

    to: new file for [transport]. at: (n,) where each joint stood at home, moved: (n,) by how many it then
    moved; degrees, or mm where joints are lengths. port: instead of the device file's. Returns a line a
    joint: what it reaches. Ctrl-C retracts the device first, and writes nothing.
    """
    watch = Watch()
    seen, ways = (np.ascontiguousarray(values, np.float64) for values in (at, moved))
    if seen.ndim != 1 or seen.shape != ways.shape:
        raise _library.InputError(f"at and moved: must have shape (n,) both, have {seen.shape} and {ways.shape}")
    options = _library.CalibrateOptions(
        size=ctypes.sizeof(_library.CalibrateOptions), count=len(seen), at=seen.ctypes.data, moved=ways.ctypes.data,
        port=_library.text(port, "port"), stop=watch.stop)
    names, note, error = (_library.path(device), _library.path(to)), ctypes.create_string_buffer(1 << 16), _library.ErrorText()
    error.check(watch.run(lambda: int(library.sf_device_calibrate(
        *names, ctypes.byref(options), note, len(note), *error.arguments)), "calibrate"))
    return [line.removeprefix("# ") for line in note.value.decode().splitlines()]


def condition(
    motion: Path,
    *,
    finger: str | None = None,
    rate_Hz: float = 120.0,
    age_ms: float = 15.0,
    noise_mm: float = 0.1,
    noise_deg: float = 0.2,
    filter: bool = False,
    predict_ms: float | None = None,
) -> dict[str, Any]:
    """What smoothing and prediction would make of a known motion; as `softfinger condition --json`.

    motion: a recording, of it `finger`, or a CSV file of poses: the truth. The tracking system sees rate_Hz
    poses a second, age_ms old, with noise of noise_mm along and noise_deg about each axis. filter,
    predict_ms: what is made of them; one must be given. Returns resting and moving, each with time_s, before
    and after, with distance_mm and turn_deg from the truth; None where the motion never is.
    """
    options = _library.ConditionOptions(
        size=ctypes.sizeof(_library.ConditionOptions), filter=filter, finger=_library.text(finger, "finger"),
        rate_Hz=rate_Hz or math.nan, age_s=age_ms * 1e-3, noise_m=noise_mm * 1e-3, noise_rad=noise_deg * (np.pi / 180.0),
        predict_s=(predict_ms or 0.0) * 1e-3, predict=predict_ms is not None)
    name = _library.path(motion)
    return report_of(Watch(), "condition", lambda *out: int(library.sf_condition(name, ctypes.byref(options), *out)))


def _metres(size_mm: float | None) -> float:
    """0 is none; so that 0 mm is refused, it is no number."""
    return 0.0 if size_mm is None else 1e-3 * size_mm or math.nan
