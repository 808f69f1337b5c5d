"""What comes in columns: presses, evaluations, recordings."""

from __future__ import annotations

import csv
import ctypes
import json
import pathlib
import shutil
import tempfile
import weakref
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _library
from ._library import library
from ._long_work import Watch
from .rendering import Floats, Path


class Columns(Mapping[str, NDArray[Any]]):
    """Arrays of one length by name, units in the names; a missing value is NaN. Made to be plotted."""

    def __init__(self, columns: Mapping[str, NDArray[Any]]) -> None:
        self._columns = dict(columns)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()))) if self._columns else 0
        return f"Columns({rows} rows: {', '.join(self._columns)})"


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
) -> Columns:
    """Presses a finger on a fixed obstacle, bone prescribed; as `softfinger press`.

    finger: finger file. to_mm: greatest bone displacement after first touch, in `steps` rows.
    sphere_mm: on a sphere of this radius, `at_mm` under the finger's origin; edge: on a 90-degree edge;
    else on a plane. angle_deg: turn about the finger's y axis, distal end down. relaxed: long-time
    moduli. speed_mm_per_s: stepped in time, then held for hold_ms; unload: then back. Ctrl-C ends it.
    """
    # As the command line has them in SI, to the bit.
    mm, ms, deg = 1e-3, 1e-3, np.pi / 180.0
    watch = Watch()
    options = _library.PressOptions(
        size=ctypes.sizeof(_library.PressOptions), rows=steps, depth_m=to_mm * mm, sphere_radius_m=sphere_mm * mm,
        at_m=(at_mm[0] * mm, at_mm[1] * mm), edge=edge, no_strain_limits=not strain_limits,
        edge_radius_m=edge_radius_mm * mm, no_friction=not friction, relaxed=relaxed, pitch_rad=angle_deg * deg,
        speed_m_per_s=speed_mm_per_s * mm, hold_s=hold_ms * ms, unload=unload, stop=watch.stop, progress=watch.progress)
    if to_mm == 0.0 or steps == 0:
        raise _library.InputError(f"to_mm {to_mm}, steps {steps}: must be above 0")
    name, table, error = _library.path(finger), ctypes.c_void_p(), _library.ErrorText()
    try:
        error.check(watch.run(lambda: int(library.sf_press(
            name, ctypes.byref(options), ctypes.byref(table), *error.arguments)), "press"))
    except KeyboardInterrupt:
        library.sf_table_destroy(table)
        raise
    return _taken(table)[0]


def evaluate(
    scene: Path,
    *,
    device: Path | None = None,
    wearer: Path | None = None,
    objective: str | None = None,
    person: Path | None = None,
    duration_s: float = 0.0,
) -> Evaluation:
    """Judges a device by a second finger that feels its commands; as `softfinger evaluate`.

    device: device file instead of the scene's. wearer: finger file of who wears it. objective: what
    matching aims at, instead of the device file's. duration_s: 0 is until the script ends. Ctrl-C ends it.
    """
    watch = Watch()
    options = _library.EvaluateOptions(
        size=ctypes.sizeof(_library.EvaluateOptions), device=_library.path(device), wearer=_library.path(wearer),
        objective=_library.text(objective, "objective"), person=_library.path(person),
        duration_s=duration_s, stop=watch.stop, progress=watch.progress)
    name, table, error = _library.path(scene), ctypes.c_void_p(), _library.ErrorText()
    try:
        error.check(watch.run(lambda: int(library.sf_evaluate(
            name, ctypes.byref(options), ctypes.byref(table), *error.arguments)), "evaluate"))
    except KeyboardInterrupt:
        library.sf_table_destroy(table)
        raise
    columns, text = _taken(table)
    return Evaluation(columns, json.loads(text))


class Recording:
    """What a run recorded, in the tables of `softfinger export`.

    `steps` has a row for each step: pose.csv (tracked), bone.csv, contact.csv, timing.csv side by side;
    columns that two of them have are prefixed with bone_ and so on. `ticks` has one for each device
    tick: configuration.csv, force.csv, joints.csv, command.csv. table() has any of them alone. With
    several fingers the column `finger` says whose a row is.
    """

    _STEPS = ("pose", "bone", "contact", "timing")
    _TICKS = ("configuration", "force", "joints", "command")

    def __init__(self, file: Path) -> None:
        folder = tempfile.mkdtemp(prefix="softfinger-")
        weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self._file, self._tables = file, pathlib.Path(folder, "csv")
        #: a line where the run did not close it, else empty
        self.note = _export(file, self._tables)

    def table(self, name: str) -> Columns:
        """NAME.csv of the export, e.g. contact, nodes (with record_state), messages. Raises InputError where there is none."""
        if name not in self.tables:
            raise _library.InputError(f"table {name}: there is {', '.join(self.tables)}")
        return _read_csv(self._tables / f"{name}.csv")

    @property
    def tables(self) -> list[str]:
        """Names that table() knows."""
        return sorted(file.stem for file in self._tables.glob("*.csv"))

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
        """For other programs: FILE.h5 is HDF5, FILE.mcap MCAP, else CSV files in a new folder.

        While HDF5 is written, h5py must do nothing on another thread: they may share one library, which is for one.
        """
        _export(self._file, to)

    def replay(self) -> str:
        """Runs it again with its recorded input. Empty where every bit is the same, else what differs first."""
        agree, difference, error = ctypes.c_int32(), ctypes.create_string_buffer(512), _library.ErrorText()
        error.check(library.sf_recording_replay(
            _library.path(self._file), ctypes.byref(agree), difference, len(difference), *error.arguments))
        return "" if agree.value else difference.value.decode()

    def _beside(self, names: tuple[str, ...]) -> Columns:
        tables = {name: self.table(name) for name in names if name in self.tables}
        columns: dict[str, NDArray[Any]] = {}
        rows = _moments(next(iter(tables.values()))) if tables else []
        for name, table in tables.items():
            at = {moment: row for row, moment in enumerate(_moments(table))}
            # The pose that a run starts from has no timing.
            order = np.array([at.get(moment, -1) for moment in rows], int)
            for key, values in table.items():
                if key in ("time_s", "finger") and key in columns:
                    continue
                padded = np.append(values, np.nan if values.dtype.kind == "f" else "")
                columns[key if key not in columns else f"{name}_{key}"] = padded[order]
        return Columns(columns)


def _moments(table: Columns) -> list[tuple[Any, ...]]:
    """What tells rows apart: the time, and the finger where there are several."""
    return list(zip(*(table[key] for key in ("time_s", "finger") if key in table)))


def _taken(table: ctypes.c_void_p) -> tuple[Columns, str]:
    """Columns and text of a table of the library, which is given back."""
    try:
        rows, count = ctypes.c_size_t(), ctypes.c_size_t()
        library.sf_table_size(table, ctypes.byref(rows), ctypes.byref(count))
        columns = {}
        for index in range(count.value):
            name, values = ctypes.create_string_buffer(256), np.empty(rows.value)
            library.sf_table_name(table, index, name, len(name), None)
            library.sf_table_column(table, index, values.ctypes.data, rows.value, None)
            columns[name.value.decode()] = values
        size = ctypes.c_size_t()
        library.sf_table_text(table, None, 0, ctypes.byref(size))
        text = ctypes.create_string_buffer(size.value)
        library.sf_table_text(table, text, size.value, None)
        return Columns(columns), text.value.decode()
    finally:
        library.sf_table_destroy(table)


def _export(recording: Path, to: Path) -> str:
    note, error = ctypes.create_string_buffer(512), _library.ErrorText()
    error.check(library.sf_recording_export(
        _library.path(recording), _library.path(to), note, len(note), *error.arguments))
    return note.value.decode()


def _read_csv(file: pathlib.Path) -> Columns:
    """Numbers where a column has nothing else, words where it has."""
    with file.open(newline="", encoding="utf-8") as stream:
        header, *rows = csv.reader(stream)
    columns = {}
    for name, values in zip(header, zip(*rows) if rows else ((),) * len(header)):
        try:
            columns[name] = np.array([float(value) if value else np.nan for value in values])
        except ValueError:
            columns[name] = np.array(values)
    return Columns(columns)
