"""Many designs, worn by many people."""

from __future__ import annotations

import ctypes
import json
import pathlib
from typing import Any

from . import _library
from ._library import library
from ._long_work import Watch
from ._tables import Columns, report_of, taken
from .rendering import Path


class Study:
    """What a study has found so far, in the folder that it was run into; also while it goes on, or was killed.

        softfinger.study("disk", "disk-study")
        softfinger.Study("disk-study").table["device.geometry.disk_radius_mm"]
    """

    def __init__(self, folder: Path) -> None:
        self.folder = pathlib.Path(folder)
        table, error = ctypes.c_void_p(), _library.ErrorText()
        error.check(library.sf_study_table(_library.path(folder), ctypes.byref(table), *error.arguments))
        #: a row a design as `softfinger study export` has them: design, parameters, objectives, constraints, feasible
        #: ("true" or "false"), reason
        self.table: Columns
        self.table, text = taken(table)
        about = json.loads(text)
        #: keys of the device file, or other numbers, that differ: columns of the table
        self.parameters: list[str] = about["parameters"]
        #: columns of the table that are made small, or large where the study says so
        self.objectives: list[str] = [told["name"] for told in about["objectives"]]
        #: columns of the table that are kept within bounds
        self.constraints: list[str] = [told["name"] for told in about["constraints"]]
        #: every design is known
        self.finished: bool = about["finished"]

    def export(self, to: Path) -> str:
        """The table as a new FILE.csv. Returns a line where the study is not finished, else nothing."""
        return export_study(self.folder, to)

    def export_device(self, design: int, to: Path) -> None:
        """The device file of a design, by its number in the table, as a new file."""
        error = _library.ErrorText()
        error.check(library.sf_study_device(_library.path(self.folder), design, _library.path(to), *error.arguments))

    def plot(self, to: Path) -> pathlib.Path:
        """report.html and its plots as SVG files, into a folder that is made if absent. Returns the page."""
        error = _library.ErrorText()
        error.check(library.sf_study_plot(_library.path(self.folder), _library.path(to), *error.arguments))
        return pathlib.Path(to, "report.html")


def study(file: Path, folder: Path, *, shard: tuple[int, int] | None = None) -> dict[str, Any]:
    """Evaluates the designs of a study file and records them in a folder; as `softfinger study FILE --out FOLDER`.

    A folder that has some of it is gone on with; one of other input is refused. shard: (i, n) is one of n
    equal parts, i from 1, all into one folder; a call without it then takes them together. Study(folder)
    reads what came out; of contacts export_study() writes it.

    Returns end (finished, shard done, awaits other shards), designs, infeasible, cases, done and recorded (of
    those, before this call), first_reason, messages. Ctrl-C ends it: what is recorded stays, and the same
    call goes on from there. In this process alone; many share out a study as shards, or by mpirun and the command.
    """
    watch = Watch()
    i, n = shard if shard is not None else (0, 0)
    if shard is not None and not 1 <= i <= n <= 1_000_000:
        raise _library.InputError(f"shard {shard}: must be (i, n), i from 1 to n")
    options = _library.StudyOptions(
        size=ctypes.sizeof(_library.StudyOptions), shard=i, shards=n, stop=watch.stop, progress=watch.progress)
    names = _library.path(file), _library.path(folder)
    return report_of(watch, "study", lambda *out: int(library.sf_study_run(*names, ctypes.byref(options), *out)))


def export_study(folder: Path, to: Path) -> str:
    """A row a design as a new FILE.csv; contacts as a new FILE.h5; as `softfinger study export`.

    Returns a line where the study is not finished, else nothing.
    """
    note, error = ctypes.create_string_buffer(512), _library.ErrorText()
    error.check(library.sf_study_export(_library.path(folder), _library.path(to), note, len(note), *error.arguments))
    return note.value.decode()
