# SPDX-License-Identifier: Apache-2.0
"""Metrics of many configurations. The numbers are those of `bitspan study`."""

from __future__ import annotations

import concurrent.futures
import csv
import difflib
import functools
import io
import itertools
import os
from typing import TYPE_CHECKING, Any, Iterable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from . import _core, _html
from ._config import Config, config_of
from ._core import InputError
from ._progress import Progress
from ._scene import Scene, scene_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    AnyScene = Scene | str | os.PathLike[str]


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


def _meter(scenes: Any, width: int, height: int) -> _core.Meter:
    several = scenes if isinstance(scenes, (list, tuple)) else [scenes]
    return _core.Meter([scene_of(scene, width, height)._handle for scene in several])


def measure(config: Config | str | os.PathLike[str] = "depth16", scenes: AnyScene | Sequence[AnyScene] = "demo", width: int = 0,
            height: int = 0) -> dict[str, float]:
    """Returns the metrics of a configuration over scenes, as `bitspan study --point` measures them.

    A metric that does not apply is absent. metrics() tells units and meanings.
    """
    return _meter(scenes, width, height).measure(config_of(config)._handle)


class Table:
    """What sweep() measured, one row per point; columns are NumPy arrays.

    table["formats.span.uv.word"]   values of a key, (n,)
    table["span.u.p999"]            a metric, (n,) float64; NaN where the point was refused, or the metric does not apply
    """

    def __init__(self, keys: Sequence[str], metrics: Sequence[str], settings: Sequence[tuple[Any, ...]],
                 results: Sequence[dict[str, float]], reasons: Sequence[str]):
        self.keys = tuple(keys)
        self.metrics = tuple(metrics)  #: those shown; table[...] has every other one too
        self.reasons = tuple(reasons)  #: why a point was refused, "" where it was measured
        self._settings = list(settings)
        self._results = list(results)

    @property
    def columns(self) -> tuple[str, ...]:
        return self.keys + self.metrics

    def __len__(self) -> int:
        return len(self._settings)

    def __getitem__(self, column: str) -> NDArray[Any]:
        if column in self.keys:
            i = self.keys.index(column)
            return np.array([point[i] for point in self._settings])
        _metric(column)
        return np.array([result.get(column, np.nan) for result in self._results])

    def rows(self) -> Iterable[tuple[Any, ...]]:
        """Returns (*values of keys, *shown metrics) per point."""
        shown = [self[m] for m in self.metrics]
        return [(*point, *(float(column[i]) for column in shown)) for i, point in enumerate(self._settings)]

    def choose(self, *, at_most: float | None = None, at_least: float | None = None, metric: str | None = None,
               cost: str = "cost.register_bits") -> dict[str, Any]:
        """Returns the settings of the cheapest point whose metric is within the limits, for Config.with_."""
        name = self.metrics[0] if metric is None else metric
        if at_most is None and at_least is None:
            raise InputError("choose: no limit; expected at_most or at_least")
        with np.errstate(invalid="ignore"):
            values = self[name]
            holds = ~np.isnan(values)
            if at_most is not None:
                holds &= values <= at_most
            if at_least is not None:
                holds &= values >= at_least
        if not holds.any():
            raise InputError(f"choose: no point has {name} within {at_least} to {at_most}; the values are {np.nanmin(values):g} to "
                             f"{np.nanmax(values):g}" if not np.isnan(values).all() else f"choose: no point has {name}")
        best = int(np.argmin(np.where(holds, self[cost], np.inf)))
        return dict(zip(self.keys, self._settings[best]))

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
        about = _metric(name)
        values = self[name]
        if ax is None:
            ax = pyplot.subplots()[1]
        for rest in dict.fromkeys(point[1:] for point in self._settings):
            at = [i for i, point in enumerate(self._settings) if point[1:] == rest]
            label = ", ".join(f"{key} = {value}" for key, value in zip(self.keys[1:], rest))
            ax.plot([self._settings[i][0] for i in at], values[at], marker="o", label=label or None)
        finite = values[np.isfinite(values)]
        if len(finite) and finite.min() > 0 and about.unit != "dB":
            ax.set_yscale("log", base=2)
        if len(self.keys) > 1:
            ax.legend()
        ax.set_xlabel(self.keys[0])
        ax.set_ylabel(f"{name} [{about.unit}]")
        ax.grid(True, alpha=0.3)
        return ax

    def __repr__(self) -> str:
        rows = [list(map(_html.text_of, row)) for row in [self.columns, *self.rows()]]
        widths = [max(len(row[i]) for row in rows) for i in range(len(self.columns))]
        return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(row, widths)) for row in rows)

    def _repr_html_(self) -> str:
        return _html.table(self.columns, self.rows())


def _points(keys: Mapping[str, Iterable[Any]]) -> tuple[list[str], list[tuple[Any, ...]]]:
    names = [str(key) for key in keys]
    try:
        axes = [list(values) if not isinstance(values, str) else [values] for values in keys.values()]
    except TypeError as error:
        raise InputError(f"sweep: {error}; expected the values of each key") from None
    if not names or any(not axis for axis in axes):
        raise InputError("sweep: no points; expected keys with their values, such as {'formats.span.uv.word': range(18, 26)}")
    return names, list(itertools.product(*axes))


def sweep(config: Config | str | os.PathLike[str], keys: Mapping[str, Iterable[Any]], metric: str | Sequence[str] = "span.u.p999",
          scenes: AnyScene | Sequence[AnyScene] = "demo", *, width: int = 0, height: int = 0, threads: int | None = None,
          progress: bool | None = None) -> Table:
    """Measures every combination of values of some keys, against `ideal`.

    config    what the points start from
    keys      key to values, such as {"formats.span.uv.word": range(18, 26)}; the last key changes fastest
    metric    a metric, or several, that the table shows; metrics() has all
    scenes    a scene or several, over which a metric is taken together; width and height [pixel] for those given by name
    threads   points measured at once; None: one per core
    progress  whether to tell how far it is; None: in a notebook and on a terminal

    A point whose settings make no legal configuration, or one that draws nothing, is refused: its metrics are NaN, and
    Table.reasons tells why. Where all points are refused, InputError is raised. Ctrl-C ends the sweep after the points that
    are being measured.
    """
    shown = [metric] if isinstance(metric, str) else list(metric)
    for name in shown:
        _metric(name)
    if not shown:
        raise InputError("sweep: no metric; expected one of bitspan.metrics()")
    if threads is not None and (not isinstance(threads, int) or threads < 1):
        raise InputError(f"threads: {threads!r}; expected an integer from 1")
    base = config_of(config)
    names, points = _points(keys)
    meter = _meter(scenes, width, height)

    def one(point: tuple[Any, ...]) -> tuple[dict[str, float], str]:
        try:
            return meter.measure(base.with_(dict(zip(names, point)))._handle), ""
        except InputError as error:
            return {}, str(error)

    with Progress(len(points), progress) as told, concurrent.futures.ThreadPoolExecutor(threads or os.cpu_count()) as pool:
        waiting = [pool.submit(one, point) for point in points]
        try:
            for _ in concurrent.futures.as_completed(waiting):
                told.step()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    results = [future.result() for future in waiting]
    if all(reason for _, reason in results):
        raise InputError(f"sweep: every point was refused; the first one: {results[0][1]}")
    return Table(names, shown, points, [values for values, _ in results], [reason for _, reason in results])
