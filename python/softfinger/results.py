"""What comes in columns: presses, evaluations, recordings."""

from __future__ import annotations

import ctypes
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _library
from ._library import library
from ._long_work import Watch
from ._tables import Columns, report_of, table_of
from .rendering import Floats, Path


class Evaluation:
    """How faithfully a device renders a scene, judged by a second finger."""

    def __init__(self, frames: Columns, report: dict[str, Any]) -> None:
        #: a row for each device tick of each finger: time_s, finger, forces, measures, lagged_ and loaded_ measures
        self.frames = frames
        #: measures over all frames, by name; None where undefined
        self.mean: dict[str, float | None] = report["mean"]
        #: the same with the servos' lag; None for devices without servos
        self.lagged_mean: dict[str, float | None] | None = report["lagged_mean"]
        #: the same where motors hold the command against the skin; None where their statics are not told
        self.loaded_mean: dict[str, float | None] | None = report["loaded_mean"]
        #: what people would notice: measure, mean, threshold, noticeable, source
        self.verdict: list[dict[str, Any]] = report["verdict"]
        #: all that `softfinger evaluate --json` prints
        self.report = report


def press(
    finger: Path,
    *,
    to_mm: float = 2.0,
    steps: int = 20,
    sphere_mm: float = 0.0,
    at_mm: tuple[float, float] = (0.0, 0.0),
    edge: bool = False,
    edge_radius_mm: float = 1.0,
    angle_deg: float = 0.0,
    strain_limits: bool = True,
    friction: bool = True,
    relaxed: bool = False,
    speed_mm_per_s: float = 0.0,
    hold_ms: float = 0.0,
    unload: bool = False,
    export: Path | None = None,
) -> Columns:
    """Presses a finger on a fixed obstacle, bone prescribed; as `softfinger press`.

    finger: finger file. to_mm: greatest bone displacement after first touch, in `steps` rows.
    sphere_mm: on a sphere of this radius, `at_mm` under the finger's origin; edge: on a 90-degree edge;
    else on a plane. angle_deg: turn about the finger's y axis, distal end down. relaxed: long-time
    moduli. speed_mm_per_s: stepped in time, then held for hold_ms; unload: then back. export: folder for
    nodes.csv, contact.csv, features.csv and patches.csv. Ctrl-C ends it.
    """
    # As the command line has them in SI, to the bit.
    mm, ms, deg = 1e-3, 1e-3, np.pi / 180.0
    watch = Watch()
    options = _library.PressOptions(
        size=ctypes.sizeof(_library.PressOptions), rows=steps, depth_m=to_mm * mm, sphere_radius_m=sphere_mm * mm,
        at_m=(at_mm[0] * mm, at_mm[1] * mm), edge=edge, no_strain_limits=not strain_limits,
        edge_radius_m=edge_radius_mm * mm, no_friction=not friction, relaxed=relaxed, pitch_rad=angle_deg * deg,
        speed_m_per_s=speed_mm_per_s * mm, hold_s=hold_ms * ms, unload=unload, stop=watch.stop, progress=watch.progress,
        export_folder=_library.path(export))
    if to_mm == 0.0 or steps == 0:
        raise _library.InputError(f"to_mm {to_mm}, steps {steps}: must be above 0")
    name = _library.path(finger)
    return table_of(watch, "press", lambda *out: int(library.sf_press(name, ctypes.byref(options), *out)))[0]


def evaluate(
    scene: Path,
    *,
    device: Path | None = None,
    wearer: Path | None = None,
    objective: str | None = None,
    person: Path | None = None,
    duration_s: float = 0.0,
    tracker: str | None = None,
) -> Evaluation:
    """Judges a device by a second finger that feels its commands; as `softfinger evaluate`.

    device: device file instead of the scene's. wearer: finger file of who wears it. objective: what
    matching aims at, instead of the device file's. duration_s: 0 is until the script ends. tracker: script
    or csv:FILE instead of the scene's. Of several fingers NAME=DEVICE, NAME=TRACKER. Ctrl-C ends it.
    """
    watch = Watch()
    options = _library.EvaluateOptions(
        size=ctypes.sizeof(_library.EvaluateOptions), device=_library.path(device), wearer=_library.path(wearer),
        objective=_library.text(objective, "objective"), person=_library.path(person),
        duration_s=duration_s, stop=watch.stop, progress=watch.progress, tracker=_library.text(tracker, "tracker"))
    name = _library.path(scene)
    columns, text = table_of(
        watch, "evaluate", lambda *out: int(library.sf_evaluate(name, ctypes.byref(options), *out)))
    return Evaluation(columns, json.loads(text))


class Recording:
    """What a run recorded, in the tables of `softfinger export`, with all digits.

    `steps` has a row for each step: pose (tracked), bone, contact, timing side by side; columns that two
    of them have are prefixed with bone_ and so on. `ticks` has one for each device tick: configuration,
    force, joints, command. table() has any of them alone. With several fingers the column `finger` says
    whose a row is. Each is read from the file when it is asked for; Ctrl-C ends that, as replay and export.
    """

    _STEPS = ("pose", "bone", "contact", "timing")
    _TICKS = ("configuration", "force", "joints", "command")

    def __init__(self, file: Path) -> None:
        self._file = _library.path(file)
        self._read: dict[str, Columns] = {}
        about = json.loads(self._table(None)[1])
        #: names that table() knows
        self.tables: list[str] = about["tables"]
        #: a line where the run did not close it, else empty
        self.note: str = about["note"]

    def table(self, name: str) -> Columns:
        """A table of the export, e.g. contact, nodes (with record_state), messages. Raises InputError where there is none."""
        if name not in self._read:
            self._read[name] = self._table(name)[0]
        return self._read[name]

    @property
    def steps(self) -> Columns:
        """A row for each step, and for the pose that the run starts from."""
        return self._beside(self._STEPS)

    @property
    def ticks(self) -> Columns:
        """A row for each device tick; without columns where there is no device."""
        return self._beside(self._TICKS)

    @property
    def poses(self) -> Floats:
        """(n, 7) tracked poses of Ft in W, as Rendering.step_many takes them: m, quaternion w, x, y, z."""
        pose = self.table("pose")
        position = [pose[name] * 1e-3 for name in ("x_mm", "y_mm", "z_mm")]
        return np.stack([*position, *(pose[name] for name in ("qw", "qx", "qy", "qz"))], axis=1)

    def export(self, to: Path) -> None:
        """For other programs: FILE.h5 is HDF5, FILE.mcap MCAP, else CSV files in a new folder. Ctrl-C leaves nothing of it.

        While HDF5 is written, h5py must do nothing on another thread: they may share one library, which is for one.
        """
        watch, name, note, error = Watch(), _library.path(to), ctypes.create_string_buffer(512), _library.ErrorText()
        error.check(watch.run(lambda: int(library.sf_export(
            self._file, name, ctypes.byref(watch.options), note, len(note), *error.arguments)), "export"))

    def replay(self, *, scene: Path | None = None, person: Path | None = None) -> str:
        """Runs it again with its recorded input. Empty where every bit is the same, else what differs first.

        scene: runs this one instead of the recorded one. person: person file instead of the recorded one.
        """
        watch = Watch()
        options = _library.ReplayOptions(
            size=ctypes.sizeof(_library.ReplayOptions), scene=_library.path(scene), person=_library.path(person),
            stop=watch.stop, progress=watch.progress)
        report = report_of(watch, "replay", lambda *out: int(library.sf_replay(self._file, ctypes.byref(options), *out)))
        return "" if report["agree"] else str(report["difference"])

    def _table(self, name: str | None) -> tuple[Columns, str]:
        watch, wanted = Watch(), _library.text(name, "table")
        return table_of(watch, "recording", lambda *out: int(library.sf_recording_table(
            self._file, wanted, ctypes.byref(watch.options), *out)))

    def _beside(self, names: tuple[str, ...]) -> Columns:
        tables = {name: self.table(name) for name in names if name in self.tables}
        columns: dict[str, NDArray[Any]] = {}
        units: dict[str, str] = {}
        rows = _moments(next(iter(tables.values()))) if tables else []
        for name, table in tables.items():
            at = {moment: row for row, moment in enumerate(_moments(table))}
            # The pose that a run starts from has no timing.
            order = np.array([at.get(moment, -1) for moment in rows], int)
            for key, values in table.items():
                if key in ("time_s", "finger") and key in columns:
                    continue
                padded = np.append(values, np.nan if values.dtype.kind == "f" else "")
                to = key if key not in columns else f"{name}_{key}"
                columns[to], units[to] = padded[order], table.units[key]
        return Columns(columns, units)


def _moments(table: Columns) -> list[tuple[Any, ...]]:
    """What tells rows apart: the time, and the finger where there are several."""
    return list(zip(*(table[key] for key in ("time_s", "finger") if key in table)))
