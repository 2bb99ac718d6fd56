# SPDX-License-Identifier: Apache-2.0
"""A bit-true, configurable, fixed-point model of a raster pipeline.

    import bitspan
    run = bitspan.render("demo", bitspan.Config("depth16"))
    run.color                    # (H, W, 4) uint8
    run.span["u"]                # raw u of every pixel of every row, (n,) int64
    run.error_map("span.u")      # u - ideal u of the pixels shown [texel], (H, W) float64

docs/python.md shows it by example. Records and their fields are those of docs/numeric-spec.md.
"""

import pathlib

from . import _core
from ._compare import Comparison, compare
from ._config import Config, Field
from ._core import InputError, StateError, ToolError
from ._costs import Area, area, costs
from ._divergence import Divergence
from ._model import Model
from ._report import report
from ._run import Run, render
from ._scene import Light, Scene, Texels
from ._search import ALGORITHMS, Certificate, Combination, Found, Step, View, search
from ._sweep import Metric, Table, measure, metrics, sweep

__version__: str = _core.version

#: The stages whose records a run has, in the order of the pipeline.
STAGES: tuple[str, ...] = _core.stages
#: What draws: `golden`, `model`, `timed` and `ideal`.
ENGINES: tuple[str, ...] = _core.engines
#: The names of Run.counters.
COUNTERS: tuple[str, ...] = _core.counters

for _error in (InputError, StateError, ToolError):
    _error.__module__ = "bitspan"
InputError.__doc__ = """Something given is not legal. The text has the form "file:line: key: what; expected ..."."""
ToolError.__doc__ = "A program that is needed, such as Yosys, is missing or broke."
StateError.__doc__ = "A call in the wrong order, on a closed model, or on one whose memory is in use."


def data_folder() -> pathlib.Path:
    """Returns the folder with config/, rtl/ and dv/ that the package brings."""
    return pathlib.Path(_core.data_folder())


__all__ = ["ALGORITHMS", "Area", "COUNTERS", "Certificate", "Combination", "Comparison", "Config", "Divergence", "ENGINES", "Field",
           "Found", "InputError", "Light", "Metric", "Model", "Run", "STAGES", "Scene", "StateError", "Step", "Table", "Texels", "ToolError",
           "View", "area", "compare", "costs", "data_folder", "measure", "metrics", "render", "report", "search", "sweep"]
