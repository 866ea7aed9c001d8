"""Milling with robots without chatter.

Verbs of the command line are functions (`robomill.plan`, `robomill.lobes`, …): files in, a `Result` out, which is the verb's JSON
document with its lists of numbers as arrays. The library's stages are modules (`robomill.stability`, `robomill.modal`, …) with the
names, units and defaults of C++: structs are made of keywords, are frozen, and share their memory with NumPy.
"""
import sys as _sys
import types as _types

from . import _robomill
from ._robomill import __version__
from .commands import Served, init, monitor_input, serve_folder
from .results import Result
from .study import sweep
from .verbs import define as _define

_library = {name: value for name, value in vars(_robomill).items() if not name.startswith("_")}
globals().update(_library)
for _name, _value in _library.items():
    if isinstance(_value, _types.ModuleType):
        _sys.modules[f"{__name__}.{_name}"] = _value
_verbs = _define(globals(), __name__)

__all__ = ["Result", "Served", "__version__", "init", "monitor_input", "serve_folder", "sweep", *_library, *_verbs]
