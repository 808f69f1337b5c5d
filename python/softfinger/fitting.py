"""A finger's constants from a press that was measured."""

from __future__ import annotations

import ctypes
import dataclasses
from typing import Any

import numpy as np

from . import _library
from ._library import library
from ._long_work import Watch
from ._tables import report_of
from .rendering import Path

_NOISES = {"likelier": 0, "relative": 1, "absolute": 2}


@dataclasses.dataclass(frozen=True)
class Estimate:
    """Of a parameter, in the unit of its name; with its 95 % interval."""

    value: float
    ci95_low: float
    ci95_high: float


@dataclasses.dataclass(frozen=True)
class Fit:
    """What the data say of a finger's skin."""

    #: youngs_modulus_kPa (youngs_modulus_factor where layers have their own), min, max: those that were estimated
    parameters: dict[str, Estimate]
    #: those that the data do not tell, each with the reason
    kept: dict[str, str]
    #: Young's moduli after the fit by their keys in the finger file
    moduli_kPa: dict[str, float]
    #: root mean square of (simulated - measured) / measured force
    force_deviation: float
    #: all that `softfinger finger fit --json` prints
    report: dict[str, Any]


def fit(
    finger: Path,
    curve: Path,
    *,
    areas: Path | None = None,
    out: Path | None = None,
    parameters: tuple[str, ...] = (),
    noise: str = "likelier",
    angle_deg: float = 0.0,
) -> Fit:
    """Young's modulus and strain limits from a press on a flat plate; as `softfinger finger fit`.

    finger: finger file to start from. curve: CSV file indentation_mm,force_N. areas: CSV file
    force_N,area_mm2. out: new finger file with what was found. parameters: of youngs_modulus_kPa, min
    and max these alone; empty: all that the data tell. noise of the forces: likelier, relative or
    absolute. angle_deg: pitch of the finger, distal end down. Ctrl-C ends it, and writes nothing.
    """
    if noise not in _NOISES:
        raise _library.InputError(f"noise {noise}: there are {', '.join(_NOISES)}")
    watch = Watch()
    options = _library.FitOptions(
        size=ctypes.sizeof(_library.FitOptions), noise=_NOISES[noise], areas=_library.path(areas),
        out=_library.path(out), parameters=",".join(parameters).encode() or None, pitch_rad=angle_deg * (np.pi / 180.0),
        stop=watch.stop)
    names = _library.path(finger), _library.path(curve)
    report = report_of(watch, "fit", lambda *out: int(library.sf_finger_fit(*names, ctypes.byref(options), *out)))
    return Fit(
        parameters={name: Estimate(**found) for name, found in report["parameters"].items()},
        kept=report["kept"], moduli_kPa=report["moduli_kPa"], force_deviation=report["force_deviation"], report=report)
