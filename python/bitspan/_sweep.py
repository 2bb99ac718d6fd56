# SPDX-License-Identifier: Apache-2.0
"""Metrics of many configurations. The numbers are those of `bitspan study`."""

from __future__ import annotations

import concurrent.futures
import csv
import difflib
import functools
import io
import itertools
import math
import os
from typing import TYPE_CHECKING, Any, Callable, Iterable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from . import _core, _html
from ._config import Config, config_of
from ._core import InputError
from ._progress import Progress
from ._run import Run
from ._scene import Scene, scene_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    AnyScene = Scene | str | os.PathLike[str]
    Own = Callable[[Run], float]
    AnyMetric = str | Own | Sequence[str | Own] | Mapping[str, Own]


class Metric(NamedTuple):
    """A number that a study measures; docs/study.md."""

    name: str
    unit: str
    high_is_better: bool
    meaning: str


@functools.lru_cache(maxsize=None)
def _metrics() -> dict[str, Metric]:
    return {m[0]: Metric(*m) for m in _core.metrics()}


def metrics() -> list[Metric]:
    """Returns every metric that there can be."""
    return list(_metrics().values())


def _metric(name: str) -> Metric:
    try:
        return _metrics()[name]
    except (KeyError, TypeError):
        near = difflib.get_close_matches(str(name), _metrics(), 3)
        raise InputError(f"{name!r} is no metric; expected one of bitspan.metrics()"
                         + (f", such as {', '.join(near)}" if near else "")) from None


def _shown(metric: AnyMetric) -> tuple[list[str], dict[str, Own]]:
    """Returns the names of the metrics, and which of them are the user's functions."""
    if isinstance(metric, Mapping):
        given: list[tuple[Any, Any]] = list(metric.items())
    else:
        several = [metric] if isinstance(metric, str) or callable(metric) else list(metric)
        given = [(getattr(m, "__name__", repr(m)), m) if callable(m) else (m, None) for m in several]
    own: dict[str, Own] = {}
    for name, function in given:
        if function is None:
            _metric(name)
            continue
        if not callable(function):
            raise InputError(f"metric {name!r}: {function!r} is no function; expected a function of a bitspan.Run")
        if not isinstance(name, str) or not name.isidentifier():
            raise InputError(f"metric {name!r}: is no name of a column; expected a function with a name, or {{name: function}}")
        if name in own:
            raise InputError(f"metric {name!r}: two functions have this name; expected {{name: function}} with different names")
        own[name] = function
    return [name for name, _ in given], own


class _Measured(NamedTuple):
    """What was measured at a point; it is empty where the point was refused."""

    all: dict[str, float] = {}  # of all scenes together
    scenes: tuple[tuple[str, dict[str, float]], ...] = ()  # of each scene, with its name


def _value_of(name: str, function: Own, run: Run) -> float:
    value = function(run)
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"metric {name!r}: returned {value!r} for scene {run.scene.name}; expected a number") from None


class _Meter:
    """Measures configurations over scenes, also by functions of the user's."""

    def __init__(self, scenes: Any, width: int, height: int, own: Mapping[str, Own]):
        several = scenes if isinstance(scenes, (list, tuple)) else [scenes]
        self._scenes = [scene_of(scene, width, height) for scene in several]
        self._core = _core.Meter([scene._handle for scene in self._scenes])
        self.own = own

    @property
    def names(self) -> list[str]:
        return [scene.name for scene in self._scenes]

    def measure(self, config: Config) -> _Measured:
        together, scenes = self._core.measure(config._handle)
        return _Measured(together, tuple(scenes))

    def with_own(self, config: Config, measured: _Measured) -> _Measured:
        """Adds the values of the user's functions. Of several scenes together it is the largest one."""
        if not self.own:
            return measured
        # A scene of which nothing is drawn has no metrics, but it has a run.
        scenes = list(measured.scenes)
        for scene in self._scenes:
            run = Run(scene, config, "model", True)
            values = {name: _value_of(name, function, run) for name, function in self.own.items()}
            scenes.append((scene.name, {name: value for name, value in values.items() if not math.isnan(value)}))
        together = dict(measured.all)
        for name in self.own:
            values_of = [values[name] for _, values in scenes if name in values]
            if values_of:
                together[name] = max(values_of)
        return _Measured(together, tuple(scenes))

    def point(self, base: Config, settings: Mapping[str, Any]) -> tuple[_Measured, str]:
        """Measures a point of a sweep or a search. The string tells why it was refused, and is "" where it was not.

        What a function of the user's raises is not caught: it ends the sweep or the search.
        """
        try:
            config = base.with_(settings)
            measured = self.measure(config)
        except InputError as error:
            return _Measured(), str(error)
        return self.with_own(config, measured), ""


def measure(config: Config | str | os.PathLike[str] = "depth16", scenes: AnyScene | Sequence[AnyScene] = "demo", width: int = 0,
            height: int = 0, *, metric: AnyMetric = ()) -> dict[str, float]:
    """Returns the metrics of a configuration over scenes, as `bitspan study --point` measures them.

    A metric that does not apply is absent. metrics() tells units and meanings. `metric` has functions of your own, as for sweep();
    their values are added.
    """
    meter = _Meter(scenes, width, height, _shown(metric)[1])
    full = config_of(config)
    return meter.with_own(full, meter.measure(full)).all


class Judge(NamedTuple):
    """A constraint, which judges the values that were measured at a point."""

    metric: str
    at_most: float | None
    at_least: float | None
    over: str

    def margin(self, value: float) -> float:
        """Returns how far a value is from the nearer limit, below 0 beyond it, as Constraint::margin of study/constraint.hpp."""
        if math.isnan(value):
            return -math.inf
        return min(math.inf if self.at_most is None else self.at_most - value,
                   math.inf if self.at_least is None else value - self.at_least)

    @property
    def limits(self) -> str:
        return ", ".join(f"{word} {limit:g}" for word, limit in (("at least", self.at_least), ("at most", self.at_most))
                         if limit is not None)

    def decisive(self, measured: _Measured) -> tuple[float, str]:
        """Returns the value that is judged, and the scene that has it: `decisive` of study/constraint.hpp."""
        values = [(of[self.metric], scene) for scene, of in measured.scenes if self.metric in of]
        if values and self.over == "worst":
            return min(values, key=lambda value: self.margin(value[0]))
        return measured.all.get(self.metric, math.nan), ""

    @staticmethod
    def of(whose: str, metric: str, limits: Any, over: str, own: Iterable[str]) -> Judge:
        """Returns the constraint of a metric; `whose` begins the errors, `own` are the user's functions."""
        if not isinstance(limits, Mapping) or not set(limits) <= {"at_most", "at_least", "over"}:
            raise InputError(f"{whose}: {metric}: {limits!r}; expected limits such as {{'at_most': 0.05}}, of at_most, at_least and over")
        made = Judge(metric, limits.get("at_most"), limits.get("at_least"), limits.get("over", over))
        if made.at_most is None and made.at_least is None:
            raise InputError(f"{whose}: {metric}: no limit; expected at_most or at_least")
        for word, limit in (("at_most", made.at_most), ("at_least", made.at_least)):
            if limit is not None and (not isinstance(limit, (int, float, np.number)) or math.isnan(limit)):
                raise InputError(f"{whose}: {metric}: {word} is {limit!r}; expected a number")
        if made.over not in ("worst", "pooled"):
            raise InputError(f"{whose}: {metric}: over is {made.over!r}; expected 'worst' or 'pooled'")
        if metric in own and made.over == "pooled":
            raise InputError(f"{whose}: {metric}: a function of one run has no value of all scenes together; "
                             "expected over = 'worst'")
        return made


class Table:
    """What sweep() measured, one row per point; columns are NumPy arrays.

    table["formats.span.uv.word"]   values of a key, (n,)
    table["span.u.p999"]            a metric, (n,) float64; NaN where the point was refused, or the metric does not apply
    """

    def __init__(self, keys: Sequence[str], metrics: Sequence[str], settings: Sequence[tuple[Any, ...]],
                 results: Sequence[_Measured], reasons: Sequence[str], own: Iterable[str] = ()):
        self.keys = tuple(keys)
        self.metrics = tuple(metrics)  #: those shown; table[...] has every other one too
        self.reasons = tuple(reasons)  #: why a point was refused, "" where it was measured
        self._settings = list(settings)
        self._results = list(results)
        self._own = frozenset(own)  # the metrics that are functions of the user's

    @property
    def columns(self) -> tuple[str, ...]:
        return self.keys + self.metrics

    def __len__(self) -> int:
        return len(self._settings)

    def __getitem__(self, column: str) -> NDArray[Any]:
        if column in self.keys:
            i = self.keys.index(column)
            return np.array([point[i] for point in self._settings])
        self._known(column)
        return np.array([result.all.get(column, np.nan) for result in self._results])

    def _known(self, metric: str) -> None:
        if metric not in self._own:
            _metric(metric)

    def rows(self) -> Iterable[tuple[Any, ...]]:
        """Returns (*values of keys, *shown metrics) per point."""
        shown = [self[m] for m in self.metrics]
        return [(*point, *(float(column[i]) for column in shown)) for i, point in enumerate(self._settings)]

    def choose(self, constraints: Mapping[str, Mapping[str, Any]] | None = None, *, at_most: float | None = None,
               at_least: float | None = None, metric: str | None = None, cost: str = "cost.register_bits",
               over: str = "worst") -> dict[str, Any]:
        """Returns the settings of the cheapest point on which every constraint holds, for Config.with_.

        constraints  metric to limits, such as {"span.u.p999": {"at_most": 0.05}, "picture.psnr_db": {"at_least": 40}}
        at_most, at_least, metric   in place of `constraints`: limits of one metric, which is the first shown one
        cost         a metric, to be as low as possible; the first one of equal points is returned
        over         "worst": every scene must hold; "pooled": all scenes together must. "over" among the limits of one
                     constraint says so for that one. What the configuration alone gives is no matter of scenes.
        """
        if constraints is None:
            if at_most is None and at_least is None:
                raise InputError("choose: no limit; expected constraints, at_most or at_least")
            constraints = {self.metrics[0] if metric is None else metric: {"at_most": at_most, "at_least": at_least}}
        elif at_most is not None or at_least is not None or metric is not None:
            raise InputError("choose: constraints beside at_most, at_least or metric; expected one of the two forms")
        if not constraints:
            raise InputError("choose: no constraint; expected one such as {'span.u.p999': {'at_most': 0.05}}")
        judged = [Judge.of("choose", name, limits, over, self._own) for name, limits in constraints.items()]
        for constraint in judged:
            self._known(constraint.metric)
        at = [[constraint.decisive(measured) for measured in self._results] for constraint in judged]
        margins = np.array([[c.margin(value) for value, _ in values] for c, values in zip(judged, at)])
        costs = np.asarray(self[cost], np.float64)
        holds = (margins >= 0).all(axis=0) & ~np.isnan(costs)
        if holds.any():
            return dict(zip(self.keys, self._settings[int(np.argmin(np.where(holds, costs, np.inf)))]))

        def found(which: int, point: int) -> str:
            value, scene = at[which][point]
            return f"{value:g}" + (f" (scene {scene})" if scene else "")

        never = [which for which in range(len(judged)) if not (margins[which] >= 0).any()]
        told = []
        for which in never:
            c, nearest = judged[which], int(np.argmax(margins[which]))
            told.append(f"no point has {c.metric}" if np.isneginf(margins[which]).all() else
                        f"no point has {c.metric} {c.limits}: the nearest value is {found(which, nearest)}")
        if not told and (margins >= 0).all(axis=0).any():
            told.append(f"no point that holds has {cost}")
        elif not told:
            nearest = int(np.argmax((margins >= 0).sum(axis=0)))
            fails = [f"{c.metric} is {found(which, nearest)}, not {c.limits}" for which, c in enumerate(judged)
                     if not margins[which, nearest] >= 0]
            settings = ", ".join(f"{key} = {value}" for key, value in zip(self.keys, self._settings[nearest]))
            told.append(f"no point holds all constraints, each holds somewhere; at {settings}, {'; '.join(fails)}")
        raise InputError("choose: " + "; ".join(told))

    def to_csv(self, path: str | os.PathLike[str] | None = None) -> str:
        """Writes a line per point, and returns the text."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow([*self.columns, "refused"])
        for row, reason in zip(self.rows(), self.reasons):
            writer.writerow([*(repr(cell) if isinstance(cell, float) else cell for cell in row), reason])
        if path is not None:
            with open(path, "w", encoding="utf-8") as file:
                file.write(out.getvalue())
        return out.getvalue()

    def plot(self, metric: str | None = None, ax: Axes | None = None) -> Axes:
        """Draws a metric over the first key, a line per combination of the others; needs Matplotlib."""
        from matplotlib import pyplot

        name = self.metrics[0] if metric is None else metric
        unit = "" if name in self._own else _metric(name).unit
        values = self[name]
        if ax is None:
            ax = pyplot.subplots()[1]
        for rest in dict.fromkeys(point[1:] for point in self._settings):
            at = [i for i, point in enumerate(self._settings) if point[1:] == rest]
            label = ", ".join(f"{key} = {value}" for key, value in zip(self.keys[1:], rest))
            ax.plot([self._settings[i][0] for i in at], values[at], marker="o", label=label or None)
        finite = values[np.isfinite(values)]
        if len(finite) and finite.min() > 0 and unit != "dB":
            ax.set_yscale("log", base=2)
        if len(self.keys) > 1:
            ax.legend()
        ax.set_xlabel(self.keys[0])
        ax.set_ylabel(f"{name} [{unit}]" if unit else name)
        ax.grid(True, alpha=0.3)
        return ax

    def __repr__(self) -> str:
        rows = [list(map(_html.text_of, row)) for row in [self.columns, *self.rows()]]
        widths = [max(len(row[i]) for row in rows) for i in range(len(self.columns))]
        return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(row, widths)) for row in rows)

    def _repr_html_(self) -> str:
        return _html.table(self.columns, self.rows())


def _threads(threads: int | None) -> int:
    """Returns how many points are measured at once."""
    if threads is not None and (not isinstance(threads, int) or threads < 1):
        raise InputError(f"threads: {threads!r}; expected an integer from 1")
    return threads or os.cpu_count() or 1


def _points(keys: Mapping[str, Iterable[Any]]) -> tuple[list[str], list[tuple[Any, ...]]]:
    names = [str(key) for key in keys]
    try:
        axes = [list(values) if not isinstance(values, str) else [values] for values in keys.values()]
    except TypeError as error:
        raise InputError(f"sweep: {error}; expected the values of each key") from None
    if not names or any(not axis for axis in axes):
        raise InputError("sweep: no points; expected keys with their values, such as {'formats.span.uv.word': range(18, 26)}")
    return names, list(itertools.product(*axes))


def sweep(config: Config | str | os.PathLike[str], keys: Mapping[str, Iterable[Any]], metric: AnyMetric = "span.u.p999",
          scenes: AnyScene | Sequence[AnyScene] = "demo", *, width: int = 0, height: int = 0, threads: int | None = None,
          progress: bool | None = None) -> Table:
    """Measures every combination of values of some keys, against `ideal`.

    config    what the points start from
    keys      key to values, such as {"formats.span.uv.word": range(18, 26)}; the last key changes fastest
    metric    a metric, or several, that the table shows; metrics() has all. One may be a function of your own, or all of them
              are {name: function}: it gets a Run of the engine `model` with its records, whose Run.ideal is the truth, and returns
              a number, NaN where the scene has none. Its name is the column's. Over several scenes the column has the largest.
    scenes    a scene or several, over which a metric is taken together; width and height [pixel] for those given by name.
              Table.choose judges each scene
    threads   points measured at once; None: one per core
    progress  whether to tell how far it is; None: in a notebook and on a terminal

    A point whose settings make no legal configuration, or one that draws nothing, is refused: its metrics are NaN, and
    Table.reasons tells why. Where all points are refused, InputError is raised. Ctrl-C ends the sweep after the points that
    are being measured.
    """
    shown, own = _shown(metric)
    if not shown:
        raise InputError("sweep: no metric; expected one of bitspan.metrics()")
    workers = _threads(threads)
    base = config_of(config)
    names, points = _points(keys)
    meter = _Meter(scenes, width, height, own)

    with Progress(progress) as told, concurrent.futures.ThreadPoolExecutor(workers) as pool:
        waiting = [pool.submit(meter.point, base, dict(zip(names, point))) for point in points]
        try:
            for i, done in enumerate(concurrent.futures.as_completed(waiting)):
                done.result()
                told.tell(f"{i + 1} of {len(points)} points")
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    results = [future.result() for future in waiting]
    if all(reason for _, reason in results):
        raise InputError(f"sweep: every point was refused; the first one: {results[0][1]}")
    return Table(names, shown, points, [values for values, _ in results], [reason for _, reason in results], own)
