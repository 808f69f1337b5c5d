"""libsoftfinger.so.0 as ctypes sees it: structs, functions, and what they refuse as exceptions."""

from __future__ import annotations

import ctypes
import os
import pathlib
import re
from ctypes import POINTER, c_char_p, c_double, c_int32, c_int64, c_size_t, c_uint8, c_uint32, c_uint64, c_void_p

MOST_COMPONENTS = 256
DONE, FAILED = 0, 1


class InputError(ValueError):
    """Something given from outside is wrong: a file, a key, a pose.

    `file`, `line` and `key` say where, as far as the message does; else they are None.
    """

    file: str | None
    line: int | None
    key: str | None

    def __init__(self, message: str) -> None:
        super().__init__(message)
        place = re.match(r"(?P<file>[^:]+\.\w+)(?::(?P<line>\d+))?: (?:(?P<key>[\w.\[\]]+): )?", message)
        self.file = place["file"] if place else None
        self.line = int(place["line"]) if place and place["line"] else None
        self.key = place["key"] if place else None


class OperationError(RuntimeError):
    """The work itself failed: a port that cannot be opened, a disk that is full."""


class Options(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("finger", c_char_p),
        ("device", c_char_p),
        ("open_device", c_int32),
        ("unused", c_int32),
        ("guard_program", c_char_p),
        ("person", c_char_p),
        ("recording", c_char_p),
        ("record_state", c_int32),
        ("filter", c_int32),
        ("predict_s", c_double),
        ("all_fingers", c_int32),
        ("threads", c_int32),
    ]


class Pose(ctypes.Structure):
    _fields_ = [("size", c_uint32), ("position_m", c_double * 3), ("quaternion_wxyz", c_double * 4)]


class Command(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("configuration_count", c_uint32),
        ("joint_count", c_uint32),
        ("state", c_int32),
        ("tick", c_int64),
        ("time_s", c_double),
        ("deviation_m2", c_double),
        ("configuration", c_double * MOST_COMPONENTS),
        ("joints", c_double * MOST_COMPONENTS),
        ("stopped", c_int32),
        ("stop_confirmed", c_int32),
        ("stops", c_uint32),
        ("set_point_count", c_uint32),
        ("set_points", c_double * MOST_COMPONENTS),
    ]


class Contact(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("samples_in_contact", c_uint32),
        ("time_s", c_double),
        ("normal_force_N", c_double),
        ("tangential_force_N", c_double),
        ("contact_area_m2", c_double),
        ("centroid_F_m", c_double * 3),
        ("mean_normal_F", c_double * 3),
        ("normal_force_sum_N", c_double),
        ("slip_ratio", c_double),
    ]


class Info(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("sample_count", c_uint32),
        ("triangle_count", c_uint32),
        ("object_count", c_uint32),
        ("configuration_count", c_uint32),
        ("joint_count", c_uint32),
        ("simulation_rate_Hz", c_double),
        ("device_rate_Hz", c_double),
        ("finger_count", c_uint32),
        ("unused", c_uint32),
    ]


class Object(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("moves", c_int32),
        ("has_joint", c_int32),
        ("soft", c_int32),
        ("joint", c_double),
        ("velocity_m_per_s", c_double * 3),
        ("angular_velocity_rad_per_s", c_double * 3),
    ]


class Event(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("kind", c_int32),
        ("time_s", c_double),
        ("impulse_N_s", c_double),
        ("object", c_uint32),
        ("other_object", c_int32),
        ("other_finger", c_int32),
        ("unused", c_int32),
    ]


class PressOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("rows", c_int32),
        ("depth_m", c_double),
        ("sphere_radius_m", c_double),
        ("at_m", c_double * 2),
        ("edge", c_int32),
        ("no_strain_limits", c_int32),
        ("edge_radius_m", c_double),
        ("no_friction", c_int32),
        ("relaxed", c_int32),
        ("pitch_rad", c_double),
        ("speed_m_per_s", c_double),
        ("hold_s", c_double),
        ("unload", c_int32),
        ("unused", c_int32),
        ("stop", POINTER(c_int32)),
        ("progress", POINTER(c_double)),
        ("export_folder", c_char_p),
    ]


class EvaluateOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("device", c_char_p),
        ("wearer", c_char_p),
        ("objective", c_char_p),
        ("person", c_char_p),
        ("duration_s", c_double),
        ("stop", POINTER(c_int32)),
        ("progress", POINTER(c_double)),
        ("tracker", c_char_p),
    ]


class RunOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("record_state", c_int32),
        ("device", c_char_p),
        ("wearer", c_char_p),
        ("person", c_char_p),
        ("recording", c_char_p),
        ("duration_s", c_double),
        ("predict_s", c_double),
        ("filter", c_int32),
        ("threads", c_int32),
        ("stop", POINTER(c_int32)),
        ("progress", POINTER(c_double)),
        ("tracker", c_char_p),
    ]


class FitOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("noise", c_int32),
        ("areas", c_char_p),
        ("out", c_char_p),
        ("parameters", c_char_p),
        ("pitch_rad", c_double),
        ("stop", POINTER(c_int32)),
    ]


class DeviceInfo(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("configuration_count", c_uint32),
        ("joint_count", c_uint32),
        ("joints_are_linear", c_int32),
    ]


class Points(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("count", c_uint32),
        ("points_F_m", c_void_p),
        ("in_contact", c_void_p),
        ("areas_m2", c_void_p),
        ("gaps_m", c_void_p),
        ("separation_m", c_double),
        ("limits", c_int32),
        ("objective", c_int32),
    ]


class Match(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("configuration_count", c_uint32),
        ("joint_count", c_uint32),
        ("joints_exist", c_int32),
        ("iterations", c_int32),
        ("termination", c_int32),
        ("deviation_m2", c_double),
        ("configuration", c_double * MOST_COMPONENTS),
        ("joints", c_double * MOST_COMPONENTS),
        ("at_limit", ctypes.c_char * 1024),
    ]


class WatchOptions(ctypes.Structure):
    _fields_ = [("size", c_uint32), ("unused", c_int32), ("stop", POINTER(c_int32)), ("progress", POINTER(c_double))]


class ReplayOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("unused", c_int32),
        ("scene", c_char_p),
        ("person", c_char_p),
        ("stop", POINTER(c_int32)),
        ("progress", POINTER(c_double)),
    ]


class RegisterOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("table_given", c_int32),
        ("finger", c_char_p),
        ("scene", c_char_p),
        ("tracker", c_char_p),
        ("model", c_char_p),
        ("length_m", c_double),
        ("breadth_m", c_double),
        ("depth_m", c_double),
        ("table_m", c_double),
        ("stop", POINTER(c_int32)),
        ("progress", POINTER(c_double)),
    ]


class DeviceFitOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("again", c_int32),
        ("name", c_char_p),
        ("wearer", c_char_p),
        ("sensor", c_char_p),
        ("fault", c_char_p),
        ("fault_at_s", c_double),
        ("sensor_noise_N", c_double),
        ("sensor_noise_given", c_int32),
        ("real_time", c_int32),
        ("seed", c_uint64),
        ("guard_program", c_char_p),
        ("stop", POINTER(c_int32)),
        ("progress", POINTER(c_double)),
        ("by_touch", c_int32),
        ("unused", c_int32),
        ("touches", POINTER(c_int32)),
    ]


class CalibrateOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("count", c_uint32),
        ("at", c_void_p),
        ("moved", c_void_p),
        ("port", c_char_p),
        ("stop", POINTER(c_int32)),
    ]


class ConditionOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("filter", c_int32),
        ("finger", c_char_p),
        ("rate_Hz", c_double),
        ("age_s", c_double),
        ("noise_m", c_double),
        ("noise_rad", c_double),
        ("predict_s", c_double),
        ("predict", c_int32),
        ("unused", c_int32),
    ]


class StudyOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("unused", c_int32),
        ("shard", c_uint32),
        ("shards", c_uint32),
        ("stop", POINTER(c_int32)),
        ("progress", POINTER(c_double)),
    ]


def _open() -> ctypes.CDLL:
    """The library beside this package, else the one of SOFTFINGER_LIBRARY, else the system's."""
    beside = pathlib.Path(__file__).with_name("libsoftfinger.so.0")
    named = os.environ.get("SOFTFINGER_LIBRARY", "libsoftfinger.so.0")
    try:
        return ctypes.CDLL(str(beside) if beside.exists() else named)
    except OSError as failure:
        raise ImportError(
            f"{failure}; build it with `./dev python`, or name it in SOFTFINGER_LIBRARY"
        ) from None


library = _open()

_SIZES = [c_size_t, POINTER(c_size_t)]
_ERROR = [c_char_p, c_size_t]
for _name, _arguments in {
    "sf_scene_finger": [c_char_p, c_size_t, c_char_p, *_SIZES, *_ERROR],
    "sf_shipped_file": [c_char_p, c_char_p, c_char_p, *_SIZES, *_ERROR],
    "sf_rendering_create": [c_char_p, POINTER(Options), POINTER(c_void_p), *_ERROR],
    "sf_rendering_destroy": [c_void_p],
    "sf_rendering_message": [c_void_p, c_char_p, c_size_t],
    "sf_rendering_step": [c_void_p, POINTER(Pose), c_double, c_void_p],
    "sf_rendering_step_matrix": [c_void_p, c_void_p, c_double, c_void_p],
    "sf_rendering_lost": [c_void_p, c_double, c_void_p],
    "sf_rendering_step_fingers": [c_void_p, c_void_p, c_void_p, c_size_t, c_double],
    "sf_rendering_select": [c_void_p, c_size_t],
    "sf_rendering_command": [c_void_p, c_void_p],
    "sf_rendering_stop": [c_void_p],
    "sf_rendering_release": [c_void_p],
    "sf_rendering_take_message": [c_void_p, c_char_p, *_SIZES],
    "sf_rendering_info": [c_void_p, POINTER(Info)],
    "sf_rendering_contact": [c_void_p, POINTER(Contact)],
    "sf_rendering_poses": [c_void_p, POINTER(Pose), POINTER(Pose)],
    "sf_rendering_positions": [c_void_p, c_void_p, *_SIZES],
    "sf_rendering_pressures": [c_void_p, c_void_p, *_SIZES],
    "sf_rendering_in_contact": [c_void_p, c_void_p, *_SIZES],
    "sf_rendering_triangles": [c_void_p, c_void_p, *_SIZES],
    "sf_rendering_object_pose": [c_void_p, c_size_t, POINTER(Pose)],
    "sf_rendering_object_name": [c_void_p, c_size_t, c_char_p, *_SIZES],
    "sf_rendering_object": [c_void_p, c_size_t, POINTER(Object)],
    "sf_rendering_object_positions": [c_void_p, c_size_t, c_void_p, *_SIZES],
    "sf_rendering_object_triangles": [c_void_p, c_size_t, c_void_p, *_SIZES],
    "sf_rendering_take_event": [c_void_p, POINTER(Event)],
    "sf_event_text": [c_int32],
    "sf_rendering_finger_name": [c_void_p, c_size_t, c_char_p, *_SIZES],
    "sf_rendering_configuration_name": [c_void_p, c_size_t, c_char_p, *_SIZES],
    "sf_rendering_close_recording": [c_void_p, *_ERROR],
    "sf_table_destroy": [c_void_p],
    "sf_table_size": [c_void_p, POINTER(c_size_t), POINTER(c_size_t)],
    "sf_table_name": [c_void_p, c_size_t, c_char_p, *_SIZES],
    "sf_table_column": [c_void_p, c_size_t, c_void_p, *_SIZES],
    "sf_table_text": [c_void_p, c_char_p, *_SIZES],
    "sf_press": [c_char_p, POINTER(PressOptions), POINTER(c_void_p), *_ERROR],
    "sf_evaluate": [c_char_p, POINTER(EvaluateOptions), POINTER(c_void_p), *_ERROR],
    "sf_run": [c_char_p, POINTER(RunOptions), POINTER(c_void_p), *_ERROR],
    "sf_finger_fit": [c_char_p, c_char_p, POINTER(FitOptions), POINTER(c_void_p), *_ERROR],
    "sf_table_unit": [c_void_p, c_size_t, c_char_p, *_SIZES],
    "sf_table_word": [c_void_p, c_size_t, c_size_t, c_char_p, *_SIZES],
    "sf_recording_table": [c_char_p, c_char_p, POINTER(WatchOptions), POINTER(c_void_p), *_ERROR],
    "sf_export": [c_char_p, c_char_p, POINTER(WatchOptions), c_char_p, c_size_t, *_ERROR],
    "sf_replay": [c_char_p, POINTER(ReplayOptions), POINTER(c_void_p), *_ERROR],
    "sf_scene_check": [c_char_p, POINTER(WatchOptions), POINTER(c_void_p), *_ERROR],
    "sf_finger_show": [c_char_p, POINTER(c_void_p), *_ERROR],
    "sf_schema": [c_char_p, c_char_p, POINTER(c_void_p), *_ERROR],
    "sf_finger_register": [c_char_p, POINTER(RegisterOptions), POINTER(c_void_p), *_ERROR],
    "sf_device_fit": [c_char_p, c_char_p, c_char_p, POINTER(DeviceFitOptions), POINTER(c_void_p), *_ERROR],
    "sf_device_calibrate": [c_char_p, c_char_p, POINTER(CalibrateOptions), c_char_p, c_size_t, *_ERROR],
    "sf_condition": [c_char_p, POINTER(ConditionOptions), POINTER(c_void_p), *_ERROR],
    "sf_study_run": [c_char_p, c_char_p, POINTER(StudyOptions), POINTER(c_void_p), *_ERROR],
    "sf_study_table": [c_char_p, POINTER(c_void_p), *_ERROR],
    "sf_study_export": [c_char_p, c_char_p, c_char_p, c_size_t, *_ERROR],
    "sf_study_device": [c_char_p, c_int64, c_char_p, *_ERROR],
    "sf_study_plot": [c_char_p, c_char_p, *_ERROR],
    "sf_device_workspace": [c_void_p, c_char_p, *_SIZES],
    "sf_rendering_move_object": [c_void_p, c_size_t, POINTER(Pose)],
    "sf_device_create": [c_char_p, POINTER(c_void_p), *_ERROR],
    "sf_device_destroy": [c_void_p],
    "sf_device_describe": [c_void_p, POINTER(DeviceInfo)],
    "sf_device_show": [c_void_p, c_char_p, *_SIZES],
    "sf_device_component": [c_void_p, c_size_t, c_char_p, c_size_t, POINTER(c_double)],
    "sf_device_home": [c_void_p, c_void_p, c_size_t],
    "sf_device_solve": [c_void_p, c_void_p, c_size_t, c_void_p, c_size_t, POINTER(c_int32), POINTER(c_int32)],
    "sf_device_pose": [c_void_p, c_void_p, c_size_t, c_void_p, c_size_t],
    "sf_device_match": [c_void_p, POINTER(Points), POINTER(Match)],
    "sf_device_message": [c_void_p, c_char_p, c_size_t],
}.items():
    getattr(library, _name).argtypes = _arguments
for _name in ("sf_rendering_destroy", "sf_table_destroy", "sf_device_destroy"):
    getattr(library, _name).restype = None
library.sf_version.restype = c_uint32
library.sf_event_text.restype = c_char_p


class ErrorText:
    """Room for the line of a call that makes something, and what becomes of its status."""

    def __init__(self) -> None:
        self._text = ctypes.create_string_buffer(2048)
        self.arguments = (self._text, c_size_t(len(self._text)))

    def check(self, status: int) -> None:
        refuse(status, self._text.value.decode(errors="replace"))


def refuse(status: int, message: str) -> None:
    """Raises what a status that is not `done` stands for."""
    if status == DONE:
        return
    # What is a flag of the command is a word of the function: --noise-mm is noise_mm.
    words = re.sub(r"(?<![\w-])--([A-Za-z][\w-]*)", lambda flag: flag[1].replace("-", "_"), message)
    raise (OperationError if status == FAILED else InputError)(words)


def path(file: str | os.PathLike[str] | None) -> bytes | None:
    """As the library takes it. Raises InputError where it would end within."""
    if file is None:
        return None
    name = os.fsencode(file)
    if b"\0" in name:
        raise InputError(f"{file!r}: no character of a file's name may be zero")
    return name


def text(word: str | None, what: str) -> bytes | None:
    """As the library takes it. Raises InputError where it is none."""
    if word is not None and (not isinstance(word, str) or "\0" in word):
        raise InputError(f"{what} {word!r}: must be text without zeros")
    return None if word is None else word.encode()


def file_of(word: str | os.PathLike[str], kinds: tuple[str, ...]) -> pathlib.Path:
    """The file that a word means: one of that name, else one that comes with softfinger, of the first of these kinds that has it."""
    found, failure = ctypes.create_string_buffer(4096), None
    for kind in kinds:
        error = ErrorText()
        try:
            error.check(library.sf_shipped_file(kind.encode(), path(word), found, len(found), None, *error.arguments))
            return pathlib.Path(os.fsdecode(found.value))
        except InputError as refused:
            failure = failure or refused
    assert failure is not None
    raise failure
