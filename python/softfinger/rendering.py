"""A finger of a scene, or all of them, step by step."""

from __future__ import annotations

import ctypes
import dataclasses
import os
import struct
import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _library
from ._library import library

Floats = NDArray[np.float64]
Path = str | os.PathLike[str]

STATES = ("disconnected", "homing", "ready", "rendering", "holding", "retracting", "stopped")


class Command:
    """What the device is told. Arrays are empty where there is no device."""

    __slots__ = ("_raw",)

    def __init__(self, raw: bytes) -> None:
        self._raw = raw

    def _field(self, name: str, form: str) -> Any:
        return struct.unpack_from(form, self._raw, getattr(_library.Command, name).offset)[0]

    def _array(self, name: str, count: str) -> Floats:
        start = getattr(_library.Command, name).offset
        return np.frombuffer(self._raw, np.float64, self._field(count, "=I"), start)

    @property
    def tick(self) -> int:
        """Counts the device's ticks from 0; -1 before the first."""
        return int(self._field("tick", "=q"))

    @property
    def time(self) -> float:
        """Of that tick, s, on the caller's clock."""
        return float(self._field("time_s", "=d"))

    @property
    def state(self) -> str:
        """disconnected, homing, ready, rendering, holding, retracting or stopped."""
        return STATES[self._field("state", "=i")]

    @property
    def deviation(self) -> float:
        """Contact surface deviation E of the match, m^2; 0 where nothing is touched."""
        return float(self._field("deviation_m2", "=d"))

    @property
    def configuration(self) -> Floats:
        """(n,) q in the device's order, rad and m; see Rendering.configuration_names."""
        return self._array("configuration", "configuration_count")

    @property
    def joints(self) -> Floats:
        """(n,) joints of q, rad, or m where they are linear."""
        return self._array("joints", "joint_count")

    @property
    def set_points(self) -> Floats:
        """(n,) one a servo, as its bus has it: a pulse width in s, or ticks, or a share."""
        return self._array("set_points", "set_point_count")

    @property
    def stopped(self) -> bool:
        """Rendering.stop() or somebody else stopped the device."""
        return bool(self._field("stopped", "=i"))

    @property
    def stop_confirmed(self) -> bool:
        """And it is a fact: who leads the servos has led them away."""
        return bool(self._field("stop_confirmed", "=i"))

    @property
    def stops(self) -> int:
        """How often the device was stopped so far."""
        return int(self._field("stops", "=I"))

    def __repr__(self) -> str:
        return f"Command(tick={self.tick}, state={self.state!r}, configuration={self.configuration})"


@dataclasses.dataclass(frozen=True)
class Snapshot:
    """The finger after a step. Arrays are read-only copies; F is the simulated finger, W the world."""

    time: float  #: s, end of the step
    X_WFt: Floats  #: (4, 4) tracked pose, m
    X_WF: Floats  #: (4, 4) simulated pose, m; in contact it stays behind
    sample_positions_F: Floats  #: (n, 3) deformed skin, m
    sample_pressures: Floats  #: (n,) Pa
    in_contact: NDArray[np.bool_]  #: (n,) whether skin around each sample touches
    X_WO: Floats  #: (objects, 4, 4) where each object is, m
    samples_in_contact: int  #: members of C
    normal_force: float  #: magnitude of the vector sum of the normal forces, N
    normal_force_sum: float  #: sum of the magnitudes, N
    tangential_force: float  #: magnitude of the vector sum, N
    contact_area: float  #: m^2
    slip_ratio: float  #: 0 nothing pulls, 1 all that touches slides one way
    centroid_F: Floats  #: (3,) weighted by force, m; zero without contact
    mean_normal_F: Floats  #: (3,) unit, out of the object; zero without contact


@dataclasses.dataclass(frozen=True)
class Object:
    """An object of the scene after a step; W is the world."""

    name: str
    X_WO: Floats  #: (4, 4) where it is, m
    moves: bool  #: by the forces on it, as a whole or in part; else what follows is zero
    velocity: Floats  #: (3,) of its centre of mass, W, m/s
    angular_velocity: Floats  #: (3,) W, rad/s
    joint: float | None  #: of a slider, m, or a hinge, rad
    soft: bool  #: it deforms: see Rendering.object_positions()


@dataclasses.dataclass(frozen=True)
class Event:
    """Something that happened to an object that moves (docs/files.md, events.csv)."""

    time: float  #: s, on the caller's clock
    kind: str  #: impact, release, click, detent or limit
    object: str  #: its name
    other: str | None  #: name of an object or a finger
    impulse: float | None  #: N s


def matrix_of(position: ArrayLike, quaternion_wxyz: ArrayLike) -> Floats:
    """(4, 4) pose of a position (3,), m, and a unit quaternion (4,) w, x, y, z."""
    w, x, y, z = (float(value) for value in np.asarray(quaternion_wxyz, np.float64))
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = position
    return matrix


def fingers(scene: Path) -> list[str]:
    """Names of the fingers of a scene file, in its order. See Rendering for one of them or all."""
    count, error = ctypes.c_size_t(1), _library.ErrorText()
    names: list[str] = []
    while len(names) < count.value:
        name = ctypes.create_string_buffer(256)
        error.check(library.sf_scene_finger(
            _library.path(scene), len(names), name, len(name), ctypes.byref(count), *error.arguments))
        names.append(name.value.decode())
    return names


class RenderedFinger:
    """A finger of a Rendering."""

    def __init__(self, rendering: Rendering, number: int, name: str, info: _library.Info) -> None:
        self._rendering, self._number, self._info = rendering, number, info
        self.name = name

    def __repr__(self) -> str:
        return f"RenderedFinger({self.name!r})"

    @property
    def command(self) -> Command:
        """The newest."""
        command = _library.Command(size=ctypes.sizeof(_library.Command))
        self._rendering._check(library.sf_rendering_command(self._selected(), ctypes.byref(command)))
        return Command(bytes(command))

    def snapshot(self) -> Snapshot:
        """The finger after the last step."""
        contact, count, objects = self._contact(), self._info.sample_count, self._info.object_count
        tracked, simulated = (_library.Pose(size=ctypes.sizeof(_library.Pose)) for _ in range(2))
        self._rendering._check(
            library.sf_rendering_poses(self._selected(), ctypes.byref(tracked), ctypes.byref(simulated)))
        return Snapshot(
            time=contact.time_s,
            X_WFt=_read_only(_matrix(tracked)),
            X_WF=_read_only(_matrix(simulated)),
            sample_positions_F=self._array(library.sf_rendering_positions, (count, 3), np.float64),
            sample_pressures=self._array(library.sf_rendering_pressures, (count,), np.float64),
            in_contact=self._array(library.sf_rendering_in_contact, (count,), np.uint8).astype(bool),
            X_WO=_read_only(np.array([self._rendering._object_pose(i) for i in range(objects)]).reshape(-1, 4, 4)),
            samples_in_contact=contact.samples_in_contact,
            normal_force=contact.normal_force_N,
            normal_force_sum=contact.normal_force_sum_N,
            tangential_force=contact.tangential_force_N,
            contact_area=contact.contact_area_m2,
            slip_ratio=contact.slip_ratio,
            centroid_F=_read_only(np.array(contact.centroid_F_m)),
            mean_normal_F=_read_only(np.array(contact.mean_normal_F)),
        )

    @property
    def device_rate(self) -> float:
        """Commands a second, Hz; 0 without a device."""
        return float(self._info.device_rate_Hz)

    @property
    def configuration_names(self) -> list[str]:
        """Of the components of q, with the unit people read: pitch_deg, ..."""
        self._selected()
        return self._rendering._names(library.sf_rendering_configuration_name, self._info.configuration_count)

    @property
    def skin_triangles(self) -> NDArray[np.uint32]:
        """(n, 3) samples at the corners, counter-clockwise from outside."""
        return self._array(library.sf_rendering_triangles, (self._info.triangle_count, 3), np.uint32)

    def _selected(self) -> ctypes.c_void_p:
        """The rendering's handle, which tells of this finger."""
        handle = self._rendering._handle
        self._rendering._check(library.sf_rendering_select(handle, self._number))
        return handle

    def _contact(self) -> _library.Contact:
        contact = _library.Contact(size=ctypes.sizeof(_library.Contact))
        self._rendering._check(library.sf_rendering_contact(self._selected(), ctypes.byref(contact)))
        return contact

    def _array(self, read: Callable[..., int], shape: tuple[int, ...], kind: type) -> NDArray[Any]:
        values: NDArray[Any] = np.empty(shape, kind)
        self._rendering._check(read(self._selected(), values.ctypes.data, shape[0], None))
        return _read_only(values)


class Rendering:
    """A soft finger explores a scene, a device answers; or all fingers of the scene, each with its own.

        with softfinger.Rendering("scenes/sphere.toml") as rendering:
            for time, X_WFt in my_tracker():
                command = rendering.step(X_WFt, time)

        with softfinger.Rendering("scenes/cup.toml", all_fingers=True) as rendering:
            for time, poses in my_hand():
                commands = rendering.step_all(poses, time)
                index, thumb = (finger.snapshot() for finger in rendering.fingers)

    scene: a scene file; its trackers and waypoints are ignored.
    finger: name of one of its fingers; the first by default.
    all_fingers: all of them instead: they touch the same objects, and can hold them between them.
    threads: that step several fingers side by side, with the same bits on any number.
    device: a device file instead of the scene's; with all_fingers NAME=FILE.
    open_device: commands are sent, by softfinger-guard, a process of its own: whatever becomes of this
        one, the device is retracted. Else they are only formed.
    guard_program: softfinger-guard, where it is not with the library.
    person: a person file: sizes of the fingers.
    record: a new file that is recorded to, with record_state nodes and samples of every step as well.
    filter, predict_s: poses are smoothed, and carried on by so many seconds, 0 to 0.05.

    Frames: W world, right-handed, z up; F finger, x out of the fingertip, y to the left seen from
    above the nail, z out of the nail. One thread at a time; stop() from any. The same calls give the
    same bits. Raises InputError and OperationError.
    """

    def __init__(
        self,
        scene: Path,
        *,
        finger: str | None = None,
        all_fingers: bool = False,
        threads: int = 1,
        device: Path | None = None,
        open_device: bool = False,
        guard_program: Path | None = None,
        person: Path | None = None,
        record: Path | None = None,
        record_state: bool = False,
        filter: bool = False,
        predict_s: float = 0.0,
    ) -> None:
        self._handle = ctypes.c_void_p()
        options = _library.Options(
            size=ctypes.sizeof(_library.Options),
            finger=_library.text(finger, "finger"),
            device=_library.path(device),
            open_device=open_device,
            guard_program=_library.path(guard_program),
            person=_library.path(person),
            recording=_library.path(record),
            record_state=record_state,
            filter=filter,
            predict_s=predict_s,
            all_fingers=all_fingers,
            threads=threads,
        )
        error = _library.ErrorText()
        error.check(library.sf_rendering_create(
            _library.path(scene), ctypes.byref(options), ctypes.byref(self._handle), *error.arguments))
        # A step has its room once, and one caller at a time in it.
        self._alone = threading.Lock()
        self._matrix = np.zeros((4, 4))
        self._matrix_address = ctypes.c_void_p(self._matrix.ctypes.data)
        self._pose = _library.Pose(size=ctypes.sizeof(_library.Pose))
        self._pose_address = ctypes.byref(self._pose)
        self._pose_numbers = np.frombuffer(memoryview(self._pose), np.float64, 7, _library.Pose.position_m.offset)
        self._command = _library.Command(size=ctypes.sizeof(_library.Command))
        self._command_address = ctypes.c_void_p(ctypes.addressof(self._command))
        info = _library.Info(size=ctypes.sizeof(_library.Info))
        self._check(library.sf_rendering_info(self._handle, ctypes.byref(info)))
        self._simulation_rate = float(info.simulation_rate_Hz)
        #: Names of the scene's objects, in the order of Snapshot.X_WO.
        self.object_names = self._names(library.sf_rendering_object_name, info.object_count)
        names = self._names(library.sf_rendering_finger_name, info.finger_count)
        self._fingers: list[tuple[str, _library.Info]] = []
        for number, name in enumerate(names):
            self._check(library.sf_rendering_select(self._handle, number))
            of_finger = _library.Info(size=ctypes.sizeof(_library.Info))
            self._check(library.sf_rendering_info(self._handle, ctypes.byref(of_finger)))
            self._fingers.append((name, of_finger))
        self._poses = (_library.Pose * len(names))(*(_library.Pose(size=ctypes.sizeof(_library.Pose)) for _ in names))
        self._tracked = (ctypes.c_int32 * len(names))()

    def __enter__(self) -> Rendering:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    def close(self) -> None:
        """Retracts the device, ends the recording. Calls after that raise InputError."""
        library.sf_rendering_destroy(self._handle)

    def step(self, X_WFt: ArrayLike, time: float) -> Command:
        """Simulates up to `time` (s, on any clock that does not go back) and returns the newest command.

        X_WFt: tracked pose in W, a (4, 4) matrix, or (7,) x, y, z in m and a unit quaternion w, x, y, z.
        The first call says where time begins and places the finger; between calls it moves straight.
        A pose that is none is taken as lost tracking and raises InputError.
        """
        if not self._alone.acquire(False):
            raise _library.InputError("another thread is inside step(); one thread at a time")
        try:
            given = X_WFt if isinstance(X_WFt, np.ndarray) else np.asarray(X_WFt, np.float64)
            seconds = _seconds(time)
            if given.shape == (4, 4):
                self._matrix[...] = given
                status = library.sf_rendering_step_matrix(
                    self._handle, self._matrix_address, seconds, self._command_address)
            elif given.shape == (7,):
                self._pose_numbers[...] = given
                status = library.sf_rendering_step(
                    self._handle, self._pose_address, seconds, self._command_address)
            else:
                raise _library.InputError(f"X_WFt: must have shape (4, 4) or (7,), has {given.shape}")
            if status:
                self._check(status)
            return Command(bytes(self._command))
        finally:
            self._alone.release()

    def lost(self, time: float) -> Command:
        """Tracking is lost, of all fingers: the device holds, after 200 ms it retracts. Else as step()."""
        self._check(library.sf_rendering_select(self._handle, 0))
        self._check(library.sf_rendering_lost(self._handle, _seconds(time), self._command_address))
        return Command(bytes(self._command))

    def step_all(self, X_WFt: Sequence[ArrayLike | None], time: float) -> list[Command]:
        """step() of all fingers, in the order of the scene: a pose for each, or None where its tracking is lost."""
        if len(X_WFt) != len(self._fingers):
            raise _library.InputError(f"X_WFt: there must be {len(self._fingers)} poses, there are {len(X_WFt)}")
        if not self._alone.acquire(False):
            raise _library.InputError("another thread is inside step(); one thread at a time")
        try:
            for number, given in enumerate(X_WFt):
                self._tracked[number] = given is not None
                if given is not None:
                    numbers = _seven(np.asarray(given, np.float64))
                    self._poses[number].position_m[:], self._poses[number].quaternion_wxyz[:] = numbers[:3], numbers[3:]
            self._check(library.sf_rendering_step_fingers(self._handle, self._poses, self._tracked, len(self._fingers), _seconds(time)))
            return [finger.command for finger in self.fingers]
        finally:
            self._alone.release()

    def step_many(self, X_WFt: ArrayLike, times: ArrayLike) -> NDArray[np.void]:
        """step() with each pose of (n, 4, 4) or (n, 7) at each time of (n,), s.

        Returns a structured array of n rows: time_s, normal_force_N, tangential_force_N,
        contact_area_m2, tick, state, configuration (q,), joints (j,); state counts in STATES.
        """
        poses, stamps = np.asarray(X_WFt, np.float64), np.asarray(times, np.float64)
        if stamps.ndim != 1 or len(poses) != len(stamps):
            raise _library.InputError(f"times: must have shape ({len(poses)},), has {stamps.shape}")
        finger = self.fingers[0]
        rows = np.zeros(len(stamps), [
            ("time_s", "f8"), ("normal_force_N", "f8"), ("tangential_force_N", "f8"), ("contact_area_m2", "f8"),
            ("tick", "i8"), ("state", "i4"),
            ("configuration", "f8", (finger._info.configuration_count,)), ("joints", "f8", (finger._info.joint_count,)),
        ])
        for row, pose, time in zip(rows, poses, stamps):
            command = self.step(pose, float(time))
            contact = finger._contact()
            row["time_s"] = time
            for name in ("normal_force_N", "tangential_force_N", "contact_area_m2"):
                row[name] = getattr(contact, name)
            row["tick"], row["state"] = command.tick, STATES.index(command.state)
            row["configuration"], row["joints"] = command.configuration, command.joints
        return rows

    def stop(self) -> None:
        """Retracts the device at once and until it is released, also while nobody steps. Any thread."""
        self._check(library.sf_rendering_stop(self._handle))

    def release(self) -> bool:
        """Asks to release it from the stops that the last step told of; Command.stopped says whether it is.

        False: nothing is stopped, or it was stopped again since.
        """
        status = library.sf_rendering_release(self._handle)
        if status != _library.FAILED:
            self._check(status)
        return bool(status == _library.DONE)

    def messages(self) -> list[str]:
        """Lines that a person should read of the device, each told once.

        What its file asks them to know, that its port is gone or back, that it was stopped and by whom.
        """
        lines: list[str] = []
        while True:
            text = ctypes.create_string_buffer(2048)
            self._check(library.sf_rendering_take_message(self._handle, text, len(text), None))
            if not text.value:
                return lines
            lines.append(text.value.decode(errors="replace"))

    def snapshot(self) -> Snapshot:
        """The finger, or the first one, after the last step."""
        return self.fingers[0].snapshot()

    @property
    def fingers(self) -> list[RenderedFinger]:
        """Each that is rendered, in the order of the scene."""
        return [RenderedFinger(self, number, *finger) for number, finger in enumerate(self._fingers)]

    def object(self, index: int) -> Object:
        """An object after the last step, by its place among object_names."""
        told = _library.Object(size=ctypes.sizeof(_library.Object))
        self._check(library.sf_rendering_object(self._handle, index, ctypes.byref(told)))
        return Object(
            name=self.object_names[index],
            X_WO=_read_only(self._object_pose(index)),
            moves=bool(told.moves),
            velocity=_read_only(np.array(told.velocity_m_per_s)),
            angular_velocity=_read_only(np.array(told.angular_velocity_rad_per_s)),
            joint=told.joint if told.has_joint else None,
            soft=bool(told.soft),
        )

    def move_object(self, index: int, X_WO: ArrayLike) -> None:
        """Has an object where the caller has it: at the time of the next step, until when it moves straight.

        X_WO: (4, 4) or (7,) as for step(). It stays where it was put last; before the first step it is there
        from the start. Raises InputError of what moves by forces or has something hang on it by a joint, and
        while a recording is made, which could not be replayed.
        """
        numbers = _seven(np.asarray(X_WO, np.float64), "X_WO")
        pose = _library.Pose(size=ctypes.sizeof(_library.Pose))
        pose.position_m[:], pose.quaternion_wxyz[:] = numbers[:3], numbers[3:]
        self._check(library.sf_rendering_move_object(self._handle, index, ctypes.byref(pose)))

    def object_positions(self, index: int) -> Floats:
        """(n, 3) points of the surface of something soft as it is deformed, W, m; of what keeps its shape none."""
        return self._surface(library.sf_rendering_object_positions, index, np.float64)

    def object_triangles(self, index: int) -> NDArray[np.uint32]:
        """(n, 3) points at the corners of that surface, counter-clockwise from outside."""
        return self._surface(library.sf_rendering_object_triangles, index, np.uint32)

    def events(self) -> list[Event]:
        """What happened to objects that move, in the order in which it was found, each told once.

        Of more than 256 that wait the oldest are forgotten.
        """
        found: list[Event] = []
        while True:
            told = _library.Event(size=ctypes.sizeof(_library.Event))
            self._check(library.sf_rendering_take_event(self._handle, ctypes.byref(told)))
            if told.kind == 0:
                return found
            other = None
            if told.other_object >= 0:
                other = self.object_names[told.other_object]
            elif told.other_finger >= 0:
                other = self._fingers[told.other_finger][0]
            found.append(Event(
                time=told.time_s, kind=library.sf_event_text(told.kind).decode(), object=self.object_names[told.object],
                other=other, impulse=None if np.isnan(told.impulse_N_s) else told.impulse_N_s))

    @property
    def simulation_rate(self) -> float:
        """Steps a second, Hz."""
        return self._simulation_rate

    @property
    def device_rate(self) -> float:
        """Commands a second of the finger, or the first one, Hz; 0 without a device."""
        return self.fingers[0].device_rate

    @property
    def configuration_names(self) -> list[str]:
        """Of the components of its q, with the unit people read: pitch_deg, ..."""
        return self.fingers[0].configuration_names

    @property
    def skin_triangles(self) -> NDArray[np.uint32]:
        """(n, 3) samples at the corners, counter-clockwise from outside."""
        return self.fingers[0].skin_triangles

    def _check(self, status: int) -> None:
        if status != _library.DONE:
            text = ctypes.create_string_buffer(512)
            library.sf_rendering_message(self._handle, text, len(text))
            _library.refuse(status, text.value.decode())

    def _surface(self, read: Callable[..., int], index: int, kind: type) -> NDArray[Any]:
        count = ctypes.c_size_t()
        self._check(read(self._handle, index, None, 0, ctypes.byref(count)))
        values: NDArray[Any] = np.empty((count.value, 3), kind)
        self._check(read(self._handle, index, values.ctypes.data, count.value, None))
        return _read_only(values)

    def _object_pose(self, index: int) -> Floats:
        pose = _library.Pose(size=ctypes.sizeof(_library.Pose))
        self._check(library.sf_rendering_object_pose(self._handle, index, ctypes.byref(pose)))
        return _matrix(pose)

    def _names(self, read: Callable[..., int], count: int) -> list[str]:
        names = []
        for index in range(count):
            name = ctypes.create_string_buffer(256)
            self._check(read(self._handle, index, name, len(name), None))
            names.append(name.value.decode())
        return names


def _seconds(time: Any) -> float:
    """Of any kind of number."""
    try:
        return float(time)
    except (TypeError, ValueError):
        raise _library.InputError(f"time {time!r}: must be a number of seconds") from None


def _matrix(pose: _library.Pose) -> Floats:
    return matrix_of(pose.position_m, pose.quaternion_wxyz)


def _seven(given: Floats, name: str = "X_WFt") -> Floats:
    """(7,) x, y, z and quaternion of a pose that is given so, or as a matrix; NaN where that is none."""
    if given.shape == (7,):
        return given
    if given.shape != (4, 4):
        raise _library.InputError(f"{name}: must have shape (4, 4) or (7,), has {given.shape}")
    rotation = given[:3, :3]
    is_pose = np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-3) and np.array_equal(given[3], [0, 0, 0, 1])
    return np.concatenate([given[:3, 3], _quaternion_of(rotation)]) if is_pose else np.full(7, np.nan)


def _quaternion_of(rotation: Floats) -> Floats:
    """(4,) w, x, y, z of a rotation matrix, by its largest part."""
    traces = np.array([np.trace(rotation), *np.diag(rotation)])
    k = int(np.argmax(traces))
    if k == 0:
        parts = [1 + traces[0], *(rotation[j, i] - rotation[i, j] for i, j in ((1, 2), (2, 0), (0, 1)))]
    else:
        i, j, m = k - 1, k % 3, (k + 1) % 3
        parts = [0.0] * 4
        parts[0] = rotation[m, j] - rotation[j, m]
        parts[1 + i] = 1 + rotation[i, i] - rotation[j, j] - rotation[m, m]
        parts[1 + j] = rotation[j, i] + rotation[i, j]
        parts[1 + m] = rotation[m, i] + rotation[i, m]
    quaternion: Floats = np.asarray(parts, np.float64) / np.linalg.norm(parts)
    return quaternion


def _read_only(values: NDArray[Any]) -> NDArray[Any]:
    values.flags.writeable = False
    return values
