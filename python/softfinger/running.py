"""A scene that follows its script, recorded."""

from __future__ import annotations

import ctypes
from typing import Any

from . import _library
from ._library import library
from ._long_work import Watch
from ._tables import report_of
from .rendering import Path


def run(
    scene: Path,
    *,
    record: Path | None = None,
    record_state: bool = False,
    device: Path | None = None,
    wearer: Path | None = None,
    person: Path | None = None,
    duration_s: float = 0.0,
    filter: bool = False,
    predict_ms: float = 0.0,
    threads: int = 1,
    tracker: str | None = None,
) -> dict[str, Any]:
    """Runs a scene until its script ends, with emulated devices; what `softfinger run --headless --json` prints.

    record: new file, for Recording. record_state: all nodes and samples of every step as well. device:
    device file instead of the scene's. wearer: finger file of whom an emulated force sensor is on.
    duration_s: 0 is until the script ends. filter, predict_ms: of tracked poses. threads: that step
    several fingers side by side. tracker: script, csv:FILE or one that streams, instead of the scene's
    (docs/trackers.md). Of several fingers NAME=DEVICE, NAME=TRACKER. Ctrl-C ends it; what was recorded until then is whole.
    """
    watch = Watch()
    options = _library.RunOptions(
        size=ctypes.sizeof(_library.RunOptions), record_state=record_state, device=_library.path(device),
        wearer=_library.path(wearer), person=_library.path(person), recording=_library.path(record),
        duration_s=duration_s, predict_s=predict_ms * 1e-3, filter=filter, threads=threads, stop=watch.stop,
        progress=watch.progress, tracker=_library.text(tracker, "tracker"))
    name = _library.path(scene)
    return report_of(watch, "run", lambda *out: int(library.sf_run(name, ctypes.byref(options), *out)))
