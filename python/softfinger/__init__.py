"""softfinger from Python: a soft fingertip explores virtual objects, a wearable device answers.

SI units and radians, as in the C interface, but where a name carries a unit (`to_mm`, `normal_force_N`).
"""

from ._library import InputError, OperationError, library as _shared_library
from .device import Device, Match
from .fitting import Estimate, Fit, fit
from .rendering import STATES, Command, Event, Object, RenderedFinger, Rendering, Snapshot, fingers, matrix_of
from .results import Columns, Evaluation, Recording, evaluate, press
from .running import run
from .sweeping import sweep

_number = _shared_library.sf_version()
__version__ = f"{_number >> 16}.{_number >> 8 & 255}.{_number & 255}"

__all__ = [
    "STATES", "Columns", "Command", "Device", "Estimate", "Evaluation", "Event", "Fit", "InputError", "Match",
    "Object", "OperationError", "Recording", "RenderedFinger", "Rendering", "Snapshot", "evaluate", "fingers", "fit", "matrix_of", "press", "run",
    "sweep",
]
