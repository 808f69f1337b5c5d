"""What files say, and whether they are good."""

from __future__ import annotations

import ctypes
import json
from typing import Any

from . import _library
from ._library import library
from ._long_work import Watch
from ._tables import report_of, taken
from .rendering import Path


def check_scene(scene: Path) -> dict[str, Any]:
    """What is in a scene, after all that a run would load was loaded; as `softfinger scene check --json`.

    Fingers with sizes of their models, devices, trackers and notices, objects with their sizes in mm and
    masses in g. Raises InputError with file, line and key. Meshes that load for the first time take a while;
    Ctrl-C ends that.
    """
    watch, name = Watch(), _library.path(scene)
    return report_of(watch, "scene", lambda *out: int(library.sf_scene_check(name, ctypes.byref(watch.options), *out)))


def show_finger(finger: Path) -> dict[str, Any]:
    """A finger file's keys and nesting, defaults filled in, and `mesh_statistics`; as `softfinger finger show --json`."""
    table, error = ctypes.c_void_p(), _library.ErrorText()
    error.check(library.sf_finger_show(_library.path(finger), ctypes.byref(table), *error.arguments))
    report: dict[str, Any] = json.loads(taken(table)[1])
    return report


def schema(what: str, kind: str | None = None) -> dict[str, Any]:
    """JSON Schema of files, for editors and checkers; as `softfinger device schema` and its like.

    what: scene, finger, person or device. kind: of device; None is all kinds.
    """
    table, error = ctypes.c_void_p(), _library.ErrorText()
    error.check(library.sf_schema(
        _library.text(what, "what"), _library.text(kind, "kind"), ctypes.byref(table), *error.arguments))
    found: dict[str, Any] = json.loads(taken(table)[1])
    return found
