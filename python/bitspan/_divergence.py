# SPDX-License-Identifier: Apache-2.0
"""The first difference between records of a design and the model's."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from . import _html


@dataclass(frozen=True)
class Divergence:
    """The first difference."""

    kind: str  #: "value": a field differs; "extra": the model has no more records
    stage: str
    record: int  #: index among the records of the stage
    triangle: int  #: -1 where the record has none, as x and y
    x: int  #: pixel, or first pixel of the row
    y: int
    field: str | None  #: None for "extra"
    expected: int  #: raw, the model's
    actual: int
    expected_value: float  #: decoded [unit]
    actual_value: float
    unit: str
    differences: int  #: values that differ, of extra records all
    frame: int = 0  #: as given to Model.draw
    draw: int = 0
    text: str = dataclasses.field(default="", repr=False)  #: one line

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        shown = {name: value for name, value in dataclasses.asdict(self).items() if name not in ("text", "frame", "draw")}
        return _html.table(["first difference", ""], shown.items(), self.text)
