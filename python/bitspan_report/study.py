# SPDX-License-Identifier: Apache-2.0
"""Holds what a study found: the contents of its database, as the report uses them."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

FIRST_OCTAVE = -64  # octaves[i] of a register counts 2^(i + FIRST_OCTAVE) <= |x| < 2^(i + 1 + FIRST_OCTAVE)


def listed_scenes(stored: str) -> list[Any] | None:
    """Returns the scenes of a point's row, dictionaries with name and hash where a study wrote them; None for no list."""
    try:
        scenes = json.loads(stored)
    except ValueError:
        return None
    if isinstance(scenes, dict):
        scenes = [{"name": name, "hash": value} for name, value in scenes.items()]
    return scenes if isinstance(scenes, list) else None


@dataclass
class Point:
    """One configuration on the study's scenes."""

    hash: str
    config_hash: str
    config: str  # TOML
    scenes: str
    refused: bool
    message: str  # why it was refused
    seconds: float
    number: int | None = None  # its place in the study; None for points that only the search met
    settings: dict[str, Any] = field(default_factory=dict)  # key of the configuration: value
    holds: bool | None = None  # every constraint; None where nothing says


@dataclass
class Register:
    """What a register held. min and max are in its own unit."""

    name: str
    format: str
    word: int
    integer: int  # integer bits, sign included
    signed: bool
    count: int
    min: float
    max: float
    used_bits: int
    headroom: int
    wraps: int
    saturations: int
    zeros: int
    octaves: list[int]  # (128,) counts

    @property
    def range_log2(self) -> tuple[int, int]:
        """Returns log2 of the smallest step, and of the magnitude that only a signed format's least value reaches."""
        return self.integer - self.word, self.integer - int(self.signed)

    @property
    def from_range(self) -> tuple[str, int]:
        """Returns the format that has the fraction bits, and no more integer bits than the observed values need, with its
        word. It has one bit at least. Where nothing was observed it is the format itself."""
        fraction = self.word - self.integer
        integer = max(self.used_bits, 1 - fraction) if self.count else self.integer
        return f"{'s' if self.signed else 'u'}{integer}.{fraction}", integer + fraction

    @property
    def short_format(self) -> str:
        """Returns the format without rounding and overflow: "s17.8"."""
        return self.format.partition(" ")[0]


@dataclass
class FieldError:
    """A field whose error was measured, in `unit`. `ulp` is that of its format, in the same unit. The statistics of the
    error are metrics."""

    stage: str
    quantity: str
    unit: str
    ulp: float
    count: int

    @property
    def name(self) -> str:
        return f"{self.stage}.{self.quantity}"


@dataclass
class Metric:
    """What the database says of a metric. `field` and `label` are empty but for statistics of a field's error."""

    name: str
    field: str  # "span.u"
    label: str  # the head of its column in a table of fields
    unit: str
    high: bool  # more is better
    role: str  # result | cost | detail
    squares_add: bool  # the squares of independent causes add up
    meaning: str


@dataclass
class BudgetRow:
    """A metric's value for the configuration, with this quantisation exact, and with all others exact."""

    quantisation: str
    metric: str
    base: float
    without: float
    alone: float


@dataclass
class Bound:
    """A proved bound of an error beside the largest one observed, both in `unit`."""

    place: str
    unit: str
    bound: float
    observed: float

    @property
    def reached(self) -> str:
        """How much of the bound was observed, in the words of `bitspan study`. It holds up to 100 %."""
        if self.observed == 0:
            return "0.0 %"
        return f"{100 * self.observed / self.bound if self.bound else math.inf:.1f} %"

    @property
    def broken(self) -> bool:
        return self.observed > self.bound


@dataclass
class Cause:
    """A colour of the map of dominant causes."""

    name: str
    colour: str  # "#rrggbb"
    pixels: int


@dataclass
class Area:
    family: str
    part: str  # of the RTL, as it stands in metrics: "" for the spans, pixel_, late_pixel_
    placed: bool
    status: str  # ok | does_not_fit | failed
    message: str
    values: dict[str, float]  # luts, ffs, multipliers, memory_bits, fmax_mhz
    tools: str

    @property
    def name(self) -> str:
        """The family, with the part where it is not the spans."""
        return self.family + (f", {self.part.rstrip('_').replace('_', ' ')} stages" if self.part else "")


@dataclass
class Varied:
    """Keys that were set together. A key's value is the value that they follow from plus its offset."""

    name: str  # "" where the plan gives none
    keys: list[str]
    offsets: list[int]

    @property
    def title(self) -> str:
        keys = ", ".join(self.keys)
        return f"{self.name} ({keys})" if self.name else keys


@dataclass
class SearchStep:
    number: int
    hash: str
    cost: float
    holds: bool
    best: bool


@dataclass
class CertificateRow:
    key: str
    from_value: str
    to_value: str
    hash: str
    failed: str
    combination: str  # of categories; empty without


@dataclass
class Combination:
    """What a search found for one combination of categories."""

    name: str
    hash: str  # empty where nothing was found
    cost: float
    evaluations: int
    stopped_by: str
    minimal: bool
    failing: str


@dataclass
class Recommendation:
    hash: str
    reason: str
    verified: str
    findings: list[str] = field(default_factory=list)  # lines on its margins and its validation


@dataclass
class MeasuredCost:
    """The cost of a point by estimates, with its ±, and by what synthesis counted."""

    hash: str
    estimated: float
    error: float
    measured: float  # NaN where synthesis failed
    message: str  # of that failure

    @property
    def inside(self) -> bool:
        return abs(self.measured - self.estimated) <= self.error


@dataclass
class View:
    """What a constraint judges on a view that no point was chosen by. NaN: the view was refused, or has no value."""

    scene: str
    value: float
    holds: bool


@dataclass
class Constraint:
    metric: str  # or an expression
    at_most: float | None
    at_least: float | None
    pooled: bool  # all scenes together are judged; else the worst scene is
    judged: str = field(init=False)  # the metric whose column has what is judged at each point

    def __post_init__(self) -> None:
        self.judged = self.metric

    @property
    def limits(self) -> list[float]:
        return [limit for limit in (self.at_least, self.at_most) if limit is not None]

    @property
    def limits_text(self) -> str:
        limits = [("at least", self.at_least), ("at most", self.at_most)]
        return " and ".join(f"{word} {limit:g}" for word, limit in limits if limit is not None)

    def __str__(self) -> str:
        return f"{self.metric} {self.limits_text}" + (", over all scenes together" if self.pooled else "")

    def margins(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns how far values are from the nearer limit, below 0 beyond it. A NaN is infinitely far beyond."""
        most = math.inf if self.at_most is None else self.at_most
        least = -math.inf if self.at_least is None else self.at_least
        with np.errstate(invalid="ignore"):  # inf - inf: there is no such limit
            return np.where(np.isnan(values), -math.inf, np.fmin(most - values, values - least))


@dataclass
class Study:
    """Everything of one study. `metrics` holds (len(points),) columns, NaN where a point has no value."""

    database: str
    version: str
    name: str
    kind: str
    plan: str
    points: list[Point]
    base: int | None  # index into points
    metrics: dict[str, NDArray[np.float64]]
    scenes: dict[str, dict[str, dict[str, float]]]  # by hash, scene and metric: recommended points and the base
    worst_scenes: dict[str, list[str]]  # by the judged metric of a constraint: the scene that decides at each point
    known: dict[str, Metric]  # every metric that a study can have, in the order of tables
    axes: list[Varied]
    base_settings: dict[str, Any]  # the base's value of each of those keys; None where it has none or was not measured
    constraints: list[Constraint]
    chosen_metrics: list[str]  # of the plan; empty: all
    cost_metric: str  # what the search lowered, or what a sweep recommends by
    errors: dict[str, list[FieldError]]  # by point hash, as all below; of the base and what is recommended
    registers: dict[str, list[Register]]
    budget: dict[str, list[BudgetRow]]
    bounds: dict[str, list[Bound]]
    pictures: dict[str, dict[str, dict[str, bytes]]]  # hash, scene, name: PNG
    causes: dict[str, dict[str, list[Cause]]]  # hash, scene
    areas: dict[str, list[Area]]  # by configuration hash
    steps: list[SearchStep]
    certificate: list[CertificateRow]
    combinations: list[Combination]
    measured_costs: list[MeasuredCost]  # of the best points of a search, the least measured first
    recommended: list[Recommendation]
    validation: dict[str, dict[int, list[View]]]  # by hash and index of the constraint; the views' order is the same

    def metric(self, name: str) -> Metric:
        """Returns what is known of a metric. A name that the database does not explain has only the name."""
        return self.known.get(name) or Metric(name, "", "", "", False, "detail", False, "")

    def unit_of(self, name: str) -> str:
        return self.metric(name).unit

    def index_of(self, point_hash: str) -> int | None:
        """Returns the index into points."""
        return self._indices.get(point_hash)

    def __post_init__(self) -> None:
        self._indices = {point.hash: i for i, point in enumerate(self.points)}
