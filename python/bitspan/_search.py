# SPDX-License-Identifier: Apache-2.0
"""The cheapest configuration on which every constraint holds. The search is that of `bitspan study`."""

from __future__ import annotations

import concurrent.futures
import math
import os
from typing import TYPE_CHECKING, Any, Callable, Iterable, Mapping, NamedTuple, Sequence

import numpy as np

from . import _core, _html
from ._config import Config, config_of
from ._core import InputError
from ._progress import Progress
from ._sweep import Judge, Table, _Measured, _metric, _Meter, _shown, _threads

if TYPE_CHECKING:
    from ._sweep import AnyMetric, AnyScene

#: The algorithms of search(); docs/search.md tells what each does.
ALGORITHMS: tuple[str, ...] = _core.search_algorithms


class Step(NamedTuple):
    """A point beside the answer: one key narrower, or one wider and another two values narrower."""

    key: str
    from_value: str
    to_value: str
    outcome: str  #: "fails", "at its smallest", "costs more", "passes", "not evaluated"
    text: str  #: what fails


class Certificate(NamedTuple):
    """What is known of the points beside the answer; str() has it in words."""

    holds: bool
    minimal: bool  #: no single step down holds at no higher cost, and no paired step at a lower one
    steps: tuple[Step, ...]
    pairs: tuple[Step, ...]
    text: str

    def __str__(self) -> str:
        return self.text


def _certificate(given: tuple[Any, ...]) -> Certificate:
    holds, minimal, steps, pairs, text = given
    return Certificate(holds, minimal, tuple(Step(*s) for s in steps), tuple(Step(*p) for p in pairs), text)


class Combination(NamedTuple):
    """What the search found with one choice of the keys that have names for values."""

    text: str
    settings: dict[str, Any]  #: empty where nothing holds
    cost: float
    evaluations: int
    certificate: Certificate
    stopped_by: str
    failing: str  #: what fails at the widest point, where nothing holds


class View(NamedTuple):
    """The answer on a scene that it was not chosen by."""

    scene: str
    holds: bool
    values: dict[str, float]  #: of each constraint's metric; NaN where the scene has none


class Found:
    """What search() found."""

    def __init__(self, base: Config, result: Mapping[str, Any], table: Table, judges: Sequence[Judge], cost: str, meter: _Meter):
        self.settings: dict[str, Any] = result["settings"]  #: of the answer, for Config.with_
        self.config: Config = base.with_(self.settings)  #: the answer
        self.cost: float = result["cost"]
        self.certificate = _certificate(result["certificate"])
        self.stopped_by: str = result["stopped_by"]  #: "done", or the limit: "evaluations", "seconds"
        self.combinations = tuple(Combination(*c[:4], _certificate(c[4]), *c[5:]) for c in result["combinations"])
        self.table = table  #: a row per evaluated point, in their order
        self._judges = judges
        self._cost = cost
        self._meter = meter
        at = [step[0] for step in result["steps"]].index(self.settings)
        #: Of each constraint, the value that decides and the scene that has it; "" stands for all scenes together.
        self.decisive: dict[str, tuple[float, str]] = {j.metric: j.decisive(table._results[at]) for j in judges}
        self.metrics: dict[str, float] = dict(table._results[at].all)  #: of the answer, over all scenes together

    def validate(self, scenes: AnyScene | Sequence[AnyScene], width: int = 0, height: int = 0) -> list[View]:
        """Judges the answer on scenes that it was not chosen by, each alone."""
        out = []
        for scene in scenes if isinstance(scenes, (list, tuple)) else [scenes]:
            meter = _Meter(scene, width, height, self._meter.own)
            try:
                measured = meter.with_own(self.config, meter.measure(self.config))
            except InputError:
                measured = _Measured()  # too narrow for it, or it draws nothing
            values = {j.metric: j.decisive(measured)[0] for j in self._judges}
            out.append(View(meter.names[0], all(j.margin(values[j.metric]) >= 0 for j in self._judges), values))
        return out

    def __repr__(self) -> str:
        settings = ", ".join(f"{key} = {value}" for key, value in self.settings.items())
        stopped = "" if self.stopped_by == "done" else f", stopped by {self.stopped_by}"
        return f"<bitspan.Found {settings}; {self._cost} = {self.cost:g}; {len(self.table)} points{stopped}>"

    def _repr_html_(self) -> str:
        rows: list[tuple[Any, ...]] = [(key, value) for key, value in self.settings.items()] + [(self._cost, self.cost)]
        for judge in self._judges:
            value, scene = self.decisive[judge.metric]
            rows.append((f"{judge.metric}, {judge.limits}" + (f", on {scene}" if scene else ""), value))
        return _html.table(("", "found"), rows) + _html.table(Step._fields, self.certificate.steps)


def _axis(keys: Any, values: Iterable[Any]) -> tuple[list[str], list[Any]]:
    """Returns the keys that are set together, and their values as the library takes them, from few bits to many."""
    names = [str(key) for key in (keys if isinstance(keys, tuple) else (keys,))]
    try:
        listed = [values] if isinstance(values, (str, bool)) else list(values)
    except TypeError as error:
        raise InputError(f"search: {', '.join(names)}: {error}; expected values") from None
    plain = [value.item() if isinstance(value, np.generic) else value for value in listed]
    for value in plain:
        if not isinstance(value, (bool, int, str)) or (isinstance(value, int) and not -(2**63) <= value < 2**63):
            raise InputError(f"search: {', '.join(names)}: {value!r} is no value; expected integers, strings or Booleans")
    if all(type(value) is int for value in plain):
        plain.sort()
    return names, plain


def _integer(what: str, value: Any, least: int, limit: int) -> int:
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not least <= value <= limit:
        raise InputError(f"search: {what} is {value!r}; expected an integer from {least} to {limit}")
    return int(value)


def _number(what: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)) or not value >= 0:
        raise InputError(f"search: {what} is {value!r}; expected a number from 0")
    return float(value)


class _Cost:
    """The cost of a point: a metric, or the user's function of the metrics over all scenes together."""

    def __init__(self, cost: str | Callable[[Mapping[str, float]], float], base: Config, own: Iterable[str]):
        self._function = cost if callable(cost) else None
        name = getattr(cost, "__name__", "") if callable(cost) else cost
        self.name = name if self._function is None or name.isidentifier() else "cost"
        if self._function is None and self.name not in own:
            _metric(self.name)
        #: Whether the configuration alone gives it, so that steps that cannot pay need no measurement.
        self.known = True
        try:
            self.known = not math.isnan(self.value(_core.costs(base._handle)))
        except LookupError:
            self.known = False

    def value(self, metrics: Mapping[str, float]) -> float:
        return float(metrics[self.name] if self._function is None else self._function(metrics))

    def add(self, measured: _Measured) -> _Measured:
        if self._function is None:
            return measured
        return measured._replace(all={**measured.all, self.name: self.value(measured.all)})


def search(config: Config | str | os.PathLike[str], keys: Mapping[Any, Iterable[Any]],
           constraints: Mapping[str, Mapping[str, Any]], scenes: AnyScene | Sequence[AnyScene] = "demo", *,
           cost: str | Callable[[Mapping[str, float]], float] = _core.default_cost, metric: AnyMetric = (), over: str = "worst",
           algorithm: str = "greedy", evaluations: int = 1000, seconds: float = 600, seed: int = 1, pairs: bool = True,
           tie: str = _core.default_cost, tie_within: float = 0, width: int = 0, height: int = 0, threads: int | None = None,
           progress: bool | None = None) -> Found:
    """Searches for the cheapest point on which every constraint holds, as `bitspan study` does with [search].

    config       what the points start from
    keys         key to values, such as {"formats.span.uv.word": range(14, 26)}; a tuple of keys gets equal values. Strings and
                 Booleans have no order: each combination of theirs is searched for itself, and Found.combinations compares them
    constraints  metric to limits, such as {"picture.wrong_subtexel_rate_2": {"at_most": 0.02}}, as for Table.choose
    scenes       every scene must hold. over="pooled", or "over" among the limits of one, judges all scenes together
    cost         a metric, to be as low as possible, or a function of a dict of metrics. Where `costs` has all that it asks for,
                 fewer points are measured
    metric       functions of your own that constraints name, as for sweep()
    algorithm    one of ALGORITHMS
    evaluations, seconds   limits; at one of them the best point so far is the answer, and Found.stopped_by says so
    pairs        whether the certificate tries paired steps
    tie, tie_within        of the points whose costs differ by at most this share, the one with the least of this metric wins
    threads, progress      as for sweep()

    Raises InputError where no point holds, and tells what fails at the widest one. Ctrl-C ends it without an answer.
    """
    shown, own = _shown(metric)
    if not isinstance(constraints, Mapping) or not constraints:
        raise InputError("search: no constraint; expected one such as {'span.u.p999': {'at_most': 0.05}}")
    judges = [Judge.of("search", name, limits, over, own) for name, limits in constraints.items()]
    for judge in judges:
        if judge.metric not in own:
            _metric(judge.metric)
    if not isinstance(keys, Mapping) or not keys:
        raise InputError("search: nothing varies; expected keys with their values, such as {'formats.span.uv.word': range(18, 26)}")
    axes = [_axis(*item) for item in keys.items()]
    limits = (_number("tie_within", tie_within), _integer("evaluations", evaluations, 1, 2**31 - 1), _number("seconds", seconds),
              _integer("seed", seed, 0, 2**64 - 1))
    base = config_of(config)
    meter = _Meter(scenes, width, height, own)
    counted = _Cost(cost, base, own)
    _metric(tie)
    points: list[dict[str, Any]] = []
    results: list[_Measured] = []
    reasons: list[str] = []

    def one(settings: dict[str, Any]) -> tuple[_Measured, str]:
        measured, reason = meter.point(base, settings)
        return (measured if reason else counted.add(measured)), reason

    def evaluate(batch: list[dict[str, Any]]) -> list[tuple[str, dict[str, float], list[tuple[str, dict[str, float]]]]]:
        waiting = [pool.submit(one, settings) for settings in batch]
        try:
            found = [future.result() for future in waiting]
        except BaseException:
            for future in waiting:
                future.cancel()
            raise
        points.extend(batch)
        results.extend(measured for measured, _ in found)
        reasons.extend(reason for _, reason in found)
        return [(reason, measured.all, list(measured.scenes)) for measured, reason in found]

    def cost_of(settings: dict[str, Any]) -> float:
        try:
            return counted.value(_core.costs(base.with_(settings)._handle))
        except (InputError, LookupError):
            return math.nan

    with Progress(progress) as told, concurrent.futures.ThreadPoolExecutor(_threads(threads)) as pool:
        def tell(phase: str, done: int, best: float | None) -> None:
            told.tell(f"{done} points, {phase}" + ("" if best is None else f", best {counted.name} {best:g}"))

        result = _core.search(axes, [(j.metric, j.at_most, j.at_least, j.over == "pooled") for j in judges], str(algorithm),
                              counted.name, tie, *limits, bool(pairs), evaluate, cost_of if counted.known else None, tell)
    if not result["found"]:
        raise InputError("search: no point holds: " + "; ".join(result["failing"]))
    names = [key for axis, _ in axes for key in axis]
    columns = list(dict.fromkeys([*(j.metric for j in judges), counted.name, *shown]))
    table = Table(names, columns, [tuple(p[name] for name in names) for p in points], results, reasons,
                  [*own, *([counted.name] if callable(cost) else [])])
    return Found(base, result, table, judges, counted.name, meter)
