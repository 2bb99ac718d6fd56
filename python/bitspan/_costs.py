# SPDX-License-Identifier: Apache-2.0
"""What a configuration costs: by its formats alone, and as synthesis builds it."""

from __future__ import annotations

import os
from typing import NamedTuple

import numpy as np

from . import _core
from ._config import Config, config_of
from ._core import InputError


class Area(NamedTuple):
    """What Yosys and nextpnr say of a configuration in an FPGA; docs/area.md tells what is counted."""

    status: str  #: "ok", "does_not_fit" (the counts stand), "failed" (the counts are 0 where Yosys failed)
    luts: int
    ffs: int
    multipliers: int
    memory_bits: int
    fmax_mhz: float  #: NaN where it was not placed
    message: str  #: what does not fit, or what a tool said
    seconds: float
    tools: str  #: their versions


def costs(config: Config | str | os.PathLike[str] = "depth16") -> dict[str, float]:
    """Returns the metrics that the configuration alone gives, in microseconds: cost.*, timing.* and estimate.* with their ±."""
    return _core.costs(config_of(config)._handle)


def area(config: Config | str | os.PathLike[str] = "depth16", family: str = "ecp5", *,
         part: str = "spans", place: bool = False, seconds: float = 1800) -> Area:
    """Synthesises the RTL of a configuration with Yosys, which takes up to a minute, and counts the cells.

    family   "ice40" or "ecp5"
    part     "spans" (the span interpolator), "pixels" (the pixel stages), "late_pixels" (the same with the depth test
             behind texture, and a stencil test)
    place    places and routes the spans with nextpnr as well, for the clock rate
    seconds  for all tools together; past it the status is "failed"

    Raises InputError where the configuration has no RTL, and ToolError where a tool is missing. Ctrl-C ends the tools.
    """
    if isinstance(seconds, bool) or not isinstance(seconds, (int, float, np.number)) or not seconds > 0:
        raise InputError(f"area: seconds is {seconds!r}; expected a number above 0")
    return Area(*_core.area(config_of(config)._handle, str(family), str(part), bool(place), float(seconds)))
