"""softfinger from Python: a soft fingertip explores virtual objects, a wearable device answers.

SI units and radians, as in the C interface, but where a name carries a unit (`to_mm`, `normal_force_N`).
"""

from ._library import InputError, OperationError, library as _shared_library
from ._tables import Columns
from .device import Device, Match
from .files import check_scene, schema, show_finger
from .fitting import Estimate, Fit, fit
from .rendering import STATES, Command, Event, Object, RenderedFinger, Rendering, Snapshot, fingers, matrix_of
from .results import Evaluation, Recording, evaluate, press
from .running import run
from .studying import Study, export_study, study
from .sweeping import sweep
from .wearing import POSTURES, calibrate_device, condition, fit_device, register_finger

_number = _shared_library.sf_version()
__version__ = f"{_number >> 16}.{_number >> 8 & 255}.{_number & 255}"

__all__ = [
    "POSTURES", "STATES", "Columns", "Command", "Device", "Estimate", "Evaluation", "Event", "Fit", "InputError", "Match",
    "Object", "OperationError", "Recording", "RenderedFinger", "Rendering", "Snapshot", "Study", "calibrate_device",
    "check_scene", "condition", "evaluate", "export_study", "fingers", "fit", "fit_device", "matrix_of", "press",
    "register_finger", "run", "schema", "show_finger", "study", "sweep",
]
