"""What a device file describes."""

from __future__ import annotations

import ctypes
import dataclasses
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _library
from ._library import library
from ._tables import read_text
from .rendering import Floats, Path

_LIMITS = ("inside", "clamp", "none")
_OBJECTIVES = ("surface", "published", "plane")
_TERMINATIONS = ("converged", "iteration_limit", "nonsmooth")


@dataclasses.dataclass(frozen=True)
class Match:
    """The configuration that touches given samples and no others."""

    configuration: Floats  #: (n,) q, rad and m
    joints: Floats | None  #: (n,) of q, rad or m; None where unreachable
    deviation: float  #: contact surface deviation E, m^2
    iterations: int
    termination: str  #: converged, iteration_limit or nonsmooth
    at_limit: tuple[str, ...]  #: joints and components that stand at a limit: joint_1, ..., or their names


class Device:
    """A device file, read. Configurations q are arrays in rad and m, in the order of `names`.

        device = softfinger.Device("devices/thimble-3rrs.toml")
        joints, reachable = device.solve(device.configuration(pitch_deg=5))
    """

    def __init__(self, file: Path) -> None:
        self._handle, error = ctypes.c_void_p(), _library.ErrorText()
        error.check(library.sf_device_create(_library.path(file), ctypes.byref(self._handle), *error.arguments))
        info = _library.DeviceInfo(size=ctypes.sizeof(_library.DeviceInfo))
        self._check(library.sf_device_describe(self._handle, ctypes.byref(info)))
        #: joints are lengths, m, else angles, rad
        self.joints_are_linear = info.joints_are_linear != 0
        self.joint_count: int = info.joint_count
        self._units: dict[str, float] = {}
        for component in range(info.configuration_count):
            name, unit = ctypes.create_string_buffer(256), ctypes.c_double()
            self._check(library.sf_device_component(self._handle, component, name, len(name), ctypes.byref(unit)))
            self._units[name.value.decode()] = unit.value
        #: (n,) q at home
        self.home: Floats = np.empty(len(self._units))
        self._check(library.sf_device_home(self._handle, self.home.ctypes.data, len(self.home)))

    def __del__(self) -> None:
        library.sf_device_destroy(self._handle)

    @property
    def names(self) -> list[str]:
        """Of the components of q, with the unit people read: pitch_deg, ..."""
        return list(self._units)

    def show(self) -> dict[str, Any]:
        """The file's keys and nesting, defaults filled in; as `softfinger device show`."""
        result: dict[str, Any] = json.loads(read_text(library.sf_device_show, self._handle))
        return result

    def workspace(self) -> dict[str, Any]:
        """How far it goes within all limits, in the units of the keys: travel_mm [min, max] at zero tilt, mid_travel_mm,
        min_tilt_at_mid_travel_deg, max_tilt_deg, or how far each axis goes; as `softfinger device workspace`."""
        result: dict[str, Any] = json.loads(read_text(library.sf_device_workspace, self._handle))
        return result

    def configuration(self, named: Mapping[str, float] | None = None, **by_name: float) -> Floats:
        """(n,) q from values by name, in the units of the names; at home where not named."""
        q = self.home.copy()
        for name, value in {**(named or {}), **by_name}.items():
            if name not in self._units:
                raise _library.InputError(f"{name}: unknown name; there is {', '.join(self._units)}")
            q[self.names.index(name)] = value * self._units[name]
        return q

    def named(self, configuration: ArrayLike) -> dict[str, float]:
        """q by name, in the units of the names."""
        values = np.asarray(configuration, np.float64)
        return {name: float(q / unit) for (name, unit), q in zip(self._units.items(), values)}

    def solve(self, configuration: ArrayLike) -> tuple[Floats | None, bool]:
        """Joints (n,) of q, rad or m, None where the linkage does not close; and whether q is in the workspace."""
        q, joints = np.ascontiguousarray(configuration, np.float64), np.empty(self.joint_count)
        closes, reachable = ctypes.c_int32(), ctypes.c_int32()
        self._check(library.sf_device_solve(
            self._handle, q.ctypes.data, q.size, joints.ctypes.data, joints.size,
            ctypes.byref(closes), ctypes.byref(reachable)))
        return (joints if closes.value else None), reachable.value != 0

    def pose(self, joints: ArrayLike) -> Floats:
        """q of joints (n,), rad or m. Raises OperationError where none in the workspace has them."""
        given, q = np.ascontiguousarray(joints, np.float64), np.empty(len(self._units))
        self._check(library.sf_device_pose(self._handle, given.ctypes.data, given.size, q.ctypes.data, q.size))
        return q

    def match(
        self,
        points_F: ArrayLike,
        in_contact: ArrayLike,
        *,
        areas: ArrayLike | None = None,
        gaps: ArrayLike | None = None,
        separation: float = 0.0,
        limits: str | None = None,
        objective: str = "surface",
    ) -> Match:
        """The configuration that touches the samples in contact and no others; as `softfinger match`.

        points_F: (n, 3) skin in F, m. in_contact: (n,) bool. areas: (n,) m^2, weights by area. gaps: (n,)
        virtual gaps, m; without, the separation is constant. separation: its tolerance, m; 0 is the
        device's. limits: inside (the default), clamp (that of published) or none. objective: surface,
        published (Levenberg-Marquardt from home; no gaps) or plane.
        """
        if objective not in _OBJECTIVES:
            raise _library.InputError(f"objective: unknown word '{objective}'; there is {', '.join(_OBJECTIVES)}")
        if limits is None:
            limits = "clamp" if objective == "published" else "inside"
        points = np.ascontiguousarray(points_F, np.float64)
        if points.ndim != 2 or points.shape[1] != 3:
            raise _library.InputError(f"points_F: must have shape (n, 3), has {points.shape}")
        flags = np.ascontiguousarray(in_contact, bool).astype(np.uint8)
        weights, distances = (None if v is None else np.ascontiguousarray(v, np.float64) for v in (areas, gaps))
        for name, values in (("in_contact", flags), ("areas", weights), ("gaps", distances)):
            if values is not None and values.shape != (len(points),):
                raise _library.InputError(f"{name}: must have shape ({len(points)},), has {values.shape}")
        if limits not in _LIMITS:
            raise _library.InputError(f"limits: unknown word '{limits}'; there is {', '.join(_LIMITS)}")
        given = _library.Points(
            size=ctypes.sizeof(_library.Points), count=len(points), points_F_m=points.ctypes.data,
            in_contact=flags.ctypes.data, areas_m2=None if weights is None else weights.ctypes.data,
            gaps_m=None if distances is None else distances.ctypes.data, separation_m=separation,
            limits=_LIMITS.index(limits), objective=_OBJECTIVES.index(objective))
        match = _library.Match(size=ctypes.sizeof(_library.Match))
        self._check(library.sf_device_match(self._handle, ctypes.byref(given), ctypes.byref(match)))
        return Match(
            np.array(match.configuration[: match.configuration_count]),
            np.array(match.joints[: match.joint_count]) if match.joints_exist else None,
            match.deviation_m2, match.iterations, _TERMINATIONS[match.termination],
            tuple(filter(None, match.at_limit.decode().split(","))))

    def _check(self, status: int) -> None:
        if status != _library.DONE:
            text = ctypes.create_string_buffer(512)
            library.sf_device_message(self._handle, text, len(text))
            _library.refuse(status, text.value.decode())
