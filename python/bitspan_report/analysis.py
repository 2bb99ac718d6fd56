# SPDX-License-Identifier: Apache-2.0
"""Computes the numbers behind the plots: fronts, curves against a width, knees, shares of the error budget."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import expression
from .study import BudgetRow, Constraint, Metric, Register, Study, Varied, View

Floats = NDArray[np.float64]

KNEE_DEFINITION = (
    "The knee is the value farthest below the straight line from the first to the last value of a curve. Errors are in "
    "octaves (log2; decibels divided by 6.02), and so are values that span a factor of 100. Up to the knee a step of "
    "the key pays well, beyond it little. Where no value lies half an octave below that line, there is no knee."
)
KNEE_DEPTH = 0.5  # octaves below the line that make a knee
MOST_METRICS = 400  # in a menu


def axis_title(metric: Metric) -> str:
    """Returns the metric with its unit in brackets."""
    return f"{metric.name} [{metric.unit}]" if metric.unit else metric.name


def pareto_front(costs: Floats, errors: Floats) -> list[int]:
    """Returns the indices of the points that no other point beats or equals in both (n,) arrays, by rising cost.

    Both are to be low. Where points are equal in both, the first stands for all. NaN and infinite points are never on
    the front.
    """
    usable = np.flatnonzero(np.isfinite(costs) & np.isfinite(errors))
    order = usable[np.lexsort((usable, errors[usable], costs[usable]))]
    lowest = np.minimum.accumulate(np.concatenate([[math.inf], errors[order]]))[:-1]
    return [int(i) for i in order[errors[order] < lowest]]


def to_minimise(metric: Metric, values: Floats) -> Floats:
    """Returns the values, negated where more is better."""
    return -values if metric.high else values


def octaves(metric: Metric, values: Floats) -> Floats:
    """Returns (n,) losses in octaves, where low is good: log2 of errors, decibels / 6.02.

    A zero counts as half of the smallest positive error of the curve. All zeros are one level.
    """
    if metric.unit == "dB":
        return -np.nan_to_num(values, posinf=400.0) / (20 * math.log10(2))
    positive = np.abs(values)[values != 0]
    floor = positive.min() / 2 if positive.size else 1.0
    return np.asarray(np.log2(np.maximum(np.abs(values), floor)), dtype=np.float64)


def knee(widths: Floats, losses: Floats) -> int | None:
    """Returns the index of the knee (KNEE_DEFINITION) of a curve of rising (n,) widths and (n,) losses in octaves."""
    if len(widths) < 3 or not np.all(np.isfinite(losses)):
        return None
    line = losses[0] + (losses[-1] - losses[0]) * (widths - widths[0]) / (widths[-1] - widths[0])
    depth = line - losses
    deepest = int(np.argmax(depth))
    return deepest if depth[deepest] >= KNEE_DEPTH else None


@dataclass
class Axis:
    """Keys that were set together, and what stands for their values at each point. That is one of them that tells all
    sets of values apart, or all of them as text."""

    keys: list[str]
    shown: str  # the axis's name, or the key whose values these are; several keys, joined, where the values are text
    values: list[Any]  # (points,); None: unknown there
    numeric: bool
    slice: list[int]  # the points that differ from the base in these keys alone
    distinct: list[Any] = field(init=False)  # its values, in the order in which the points have them
    codes: NDArray[np.int64] = field(init=False)  # (points,) indices into distinct; -1: unknown there

    def __post_init__(self) -> None:
        numbers = {value: i for i, value in enumerate(dict.fromkeys(v for v in self.values if v is not None))}
        self.distinct = list(numbers)
        self.codes = np.array([-1 if v is None else numbers[v] for v in self.values], dtype=np.int64)

    @property
    def label(self) -> str:
        if self.shown not in self.keys:
            return self.shown
        others = [key for key in self.keys if key != self.shown]
        more = f" and {len(others) - 1} more" if len(others) > 1 else ""
        return self.shown + (f" with {others[0]}{more}" if others else "")


@dataclass
class Curve:
    """A metric over the values of an axis. Samples are (value, metric, index of the point), by rising value."""

    samples: list[tuple[Any, float, int]]
    knee: int | None  # index into samples
    one_at_a_time: bool  # samples differ from the base in the axis alone; else each is the best with its value


def read_axes(study: Study) -> list[Axis]:
    """Returns the axes along which the measured points of a study differ."""
    base = study.base_settings
    axes = []
    columns = {key: [point.settings.get(key, value) for point in study.points] for key, value in base.items()}
    changed = {key: np.array([v != base[key] for v in column], dtype=np.int64) for key, column in columns.items()}
    for varied in study.axes:
        keys = varied.keys
        sets = list(zip(*(columns[key] for key in keys)))
        known = [not point.refused and None not in values for point, values in zip(study.points, sets)]
        distinct = {values for values, ok in zip(sets, known) if ok}
        if len(distinct) < 2:
            continue
        others = sum((changed[key] for key in base if key not in keys), np.zeros(len(known), dtype=np.int64))
        alone = [int(i) for i in np.flatnonzero(np.array(known) & (others == 0))]
        own = _own_values(varied, sets, known, tuple(base[key] for key in keys)) if varied.name else None
        if own is not None:
            numeric = all(_is_number(value) for value in own if value is not None)
            axes.append(Axis(keys, varied.name, own, numeric, alone))
            continue
        telling = [k for k in range(len(keys)) if len({values[k] for values in distinct}) == len(distinct)]
        if telling:
            column = [values[telling[0]] if ok else None for values, ok in zip(sets, known)]
            numeric = all(_is_number(value) for value in column if value is not None)
            axes.append(Axis(keys, keys[telling[0]], column, numeric, alone))
        else:
            texts = [" ".join(map(str, values)) if ok else None for values, ok in zip(sets, known)]
            axes.append(Axis(keys, _together(keys), texts, False, alone))
        axes[-1].shown = varied.name or axes[-1].shown
    return axes


def _own_values(
    varied: Varied, sets: Sequence[tuple[Any, ...]], known: Sequence[bool], base: tuple[Any, ...]
) -> list[Any] | None:
    """Returns the one value per point that the keys follow from, None where it is unknown. The base's keys need not
    follow from one value. Where those of other points do not, there is no such column."""
    column: list[Any] = []
    for values, ok in zip(sets, known):
        own = [v - offset if offset else v for v, offset in zip(values, varied.offsets)] if ok else [None]
        if all(v == own[0] for v in own):
            column.append(own[0])
        elif values == base:
            column.append(None)
        else:
            return None
    return column


def _together(keys: list[str]) -> str:
    """Returns the name of several keys, with what they share only once: "reciprocal.pixel: kind, steps"."""
    parts = [key.split(".") for key in keys]
    shared = 0
    while all(len(p) > shared + 1 and p[shared] == parts[0][shared] for p in parts):
        shared += 1
    prefix = ".".join(parts[0][:shared])
    return (f"{prefix}: " if prefix else "") + ", ".join(".".join(p[shared:]) for p in parts)


def idle_axes(study: Study, axes: list[Axis]) -> list[tuple[Axis, int]]:
    """Returns the axes that did not move the cost, each with the number of sets of points that show it: the points of a
    set have a cost, and differ in this axis alone."""
    costs = study.metrics.get(study.cost_metric)
    if costs is None or not axes:
        return []
    codes = np.array([axis.codes for axis in axes])
    usable = np.isfinite(costs) & (codes >= 0).all(axis=0)
    if not usable.any():
        return []
    codes, costs = codes[:, usable], costs[usable]
    idle = []
    for i, axis in enumerate(axes):
        others = codes.copy()
        others[i] = 0
        _, sets = np.unique(others, axis=1, return_inverse=True)
        moves = _spread(codes[i], sets) > 0
        if moves.any() and not _spread(costs, sets)[moves].any():
            idle.append((axis, int(moves.sum())))
    return idle


def _spread(values: NDArray[Any], sets: NDArray[np.int64]) -> NDArray[Any]:
    """Returns the greatest less the least value of each set; sets are numbered without gaps."""
    order = np.argsort(sets, kind="stable")
    starts = np.flatnonzero(np.diff(sets[order], prepend=-1))
    return np.maximum.reduceat(values[order], starts) - np.minimum.reduceat(values[order], starts)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def varied_registers(study: Study) -> list[Register]:
    """Returns what the base's registers held whose formats the study varies, in the order of its keys."""
    base = study.points[study.base].hash if study.base is not None else ""
    known = {register.name: register for register in study.registers.get(base, [])}
    keys = (key.removeprefix("formats.").rpartition(".") for varied in study.axes for key in varied.keys)
    names = dict.fromkeys(name for name, _, part in keys if part in ("word", "int", "fraction"))
    return [known[name] for name in names if name in known]


def spans_decades(values: Sequence[float]) -> bool:
    """Whether a key's values need a logarithmic axis: they are positive, and span a factor of 100 or more."""
    return len(values) > 0 and min(values) > 0 and max(values) >= 100 * min(values)


def curve(axis: Axis, metric: Metric, column: Floats) -> Curve:
    """Returns the metric's curve over an axis; column is (points,).

    The curve goes through the base where at least three values were tried with all else as in the base. Otherwise it
    has the best point of each value, whatever else that point has.
    """
    one_at_a_time = len({axis.values[i] for i in axis.slice} - {None}) >= 3
    candidates = np.array(axis.slice, dtype=np.int64) if one_at_a_time else np.arange(len(axis.values))
    candidates = candidates[(axis.codes[candidates] >= 0) & ~np.isnan(column[candidates])]
    candidates = candidates[np.argsort(to_minimise(metric, column)[candidates], kind="stable")]
    codes, first = np.unique(axis.codes[candidates], return_index=True)
    best = {axis.distinct[code]: int(candidates[i]) for code, i in zip(codes, first)}
    ordered = sorted(best) if axis.numeric else list(best)
    samples = [(value, float(column[best[value]]), best[value]) for value in ordered]
    at = None
    if axis.numeric:
        positions = np.array(ordered, dtype=np.float64)
        at = knee(
            np.log2(positions) if spans_decades(ordered) else positions,
            octaves(metric, np.array([s[1] for s in samples])),
        )
    return Curve(samples, at, one_at_a_time)


def _varies(column: Floats) -> bool:
    finite = column[~np.isnan(column)]
    return finite.size > 0 and (column.size < 2 or bool(finite.min() != finite.max()))


def _is_cost(study: Study, name: str) -> bool:
    return study.metric(name).role == "cost"


def cost_metrics(study: Study) -> list[str]:
    """Returns the costs that have values: the study's cost first, then the others in the order of the known metrics."""
    names = [n for n in study.known if n in study.metrics and _is_cost(study, n)]
    names.sort(key=lambda n: n != study.cost_metric)
    return names or list(study.metrics)[:1]


def error_metrics(study: Study) -> list[str]:
    """Returns the errors of a menu: those of the plan and its constraints, or all that differ between points.

    What constraints judge comes first, since a point's verdict is seen there alone.
    """
    worst = sorted(study.worst_scenes, key=lambda n: not _varies(study.metrics[n]))
    named = [*worst, *study.chosen_metrics, *(c.metric for c in study.constraints)]
    named = [n for n in dict.fromkeys(named) if n in study.metrics and not _is_cost(study, n)]
    if study.chosen_metrics and named:
        return named
    rest = [n for n, column in study.metrics.items() if study.metric(n).role == "result" and _varies(column)]
    rest.sort(key=lambda n: (n != "span.u.p999", not n.startswith("span."), not n.endswith(".p999"), n))
    return list(dict.fromkeys([*named, *rest]))[:MOST_METRICS] or list(study.metrics)[:1]


@dataclass
class SceneColumn:
    """A metric of each scene alone, at each point."""

    values: Floats  # (scenes, points)
    there: NDArray[np.bool_]  # (scenes, points); false: the scene does not have the metric


def scene_column(text: str, scenes: dict[str, SceneColumn], pooled: dict[str, Floats]) -> SceneColumn | None:
    """Returns what each scene gives a metric or an expression; None where none gives anything.

    An expression takes from all scenes together what a scene has no share in, such as a cost.
    """
    if text in scenes:
        return scenes[text]
    names = expression.metrics_of(text)
    if not any(n in scenes for n in names) or not all(n in scenes or n in pooled for n in names):
        return None
    used, share, known = {}, np.array(False), np.array(True)
    for name in names:
        all_together = pooled.get(name, np.array(math.nan))
        own = scenes.get(name, SceneColumn(all_together, np.array(False)))
        used[name] = np.where(own.there, own.values, all_together)
        share, known = share | own.there, known & (own.there | ~np.isnan(all_together))
    return SceneColumn(expression.value_of(text, used), share & known)


def decisive(constraint: Constraint, scenes: SceneColumn, pooled: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Returns what a constraint judges at each point, and the scene that has it, -1 for all scenes together.

    It is the scene that is nearest to the limit or farthest beyond it, and the first of equal ones.
    """
    values, scene = pooled.copy(), np.full(pooled.shape, -1)
    least = np.full(pooled.shape, math.inf)
    for i, (own, there) in enumerate(zip(scenes.values, scenes.there)):
        margins = constraint.margins(own)
        worse = there & ((scene < 0) | (margins < least))
        values[worse], least[worse], scene[worse] = own[worse], margins[worse], i
    return values, scene


def finite_views(views: Sequence[View]) -> list[View]:
    """Returns the views that have a finite value, by rising value."""
    return sorted((view for view in views if math.isfinite(view.value)), key=lambda view: view.value)


def held_text(views: Sequence[View]) -> str:
    """Returns on how many of the views the constraint holds, and how many have no finite value to be drawn."""
    held, unknown = sum(view.holds for view in views), len(views) - len(finite_views(views))
    return f"{held} of {len(views)} hold" + (f"; {unknown} without a finite value" if unknown else "")


def unseen_panels(study: Study, point_hash: str) -> list[tuple[str, Constraint, list[View]]]:
    """Returns the title, the constraint and the views of each constraint that was validated at a recommended point."""
    judged = [(study.constraints[i], views) for i, views in study.validation[point_hash].items()]
    return [(axis_title(study.metric(c.metric)), c, views) for c, views in judged]


def column_to_minimise(study: Study, metric: str) -> Floats:
    """Returns (points,) values of a metric, negated where more is better."""
    return to_minimise(study.metric(metric), study.metrics[metric])


def front_of(study: Study, costs: Floats, errors: Floats) -> list[int]:
    """Returns the front of the points that fail no constraint."""
    fails = np.array([p.holds is False for p in study.points], dtype=bool)
    return pareto_front(np.where(fails, math.nan, costs), errors)


def noted_points(study: Study, most: int = 40) -> list[str]:
    """Returns the hashes of the points that a reader looks at.

    They are the recommended ones, the base, and the front of the first two metrics.
    """
    hashes = [found.hash for found in study.recommended]
    hashes += [study.points[study.base].hash] if study.base is not None else []
    for x, y in zip(cost_metrics(study)[:1], error_metrics(study)[:1]):
        front = front_of(study, column_to_minimise(study, x), column_to_minimise(study, y))
        hashes += [study.points[i].hash for i in front]
    return list(dict.fromkeys(hashes))[:most]


def told_metrics(study: Study) -> list[str]:
    """Returns the metrics of the page's tables: where the plan names some, those, its constraints and all costs."""
    if not study.chosen_metrics:
        return list(study.metrics)
    wanted = {*error_metrics(study), *cost_metrics(study)}
    return [n for n in study.metrics if n in wanted]


@dataclass
class Stack:
    """A metric's error budget: what each quantisation contributes on its own, as a fraction of the whole error.

    `common` is the error that even the smallest of them has: the rounding of the output, the snap of the input.
    """

    metric: str
    base: float
    powers: bool  # true for an RMS: the shares are squares, which add where the causes are independent
    shares: list[tuple[str, float]]  # quantisation, fraction of base (of its square) beyond common; the largest first
    common: float


def budget_stacks(metric_of: Callable[[str], Metric], rows: list[BudgetRow]) -> list[Stack]:
    """Returns the stacks of a configuration's budget, without metrics that have no error or are better high."""
    stacks = []
    for metric in dict.fromkeys(row.metric for row in rows):
        of_metric = [row for row in rows if row.metric == metric and math.isfinite(row.alone)]
        if not of_metric or metric_of(metric).high:
            continue
        base = of_metric[0].base
        if not math.isfinite(base) or base <= 0:
            continue
        powers = metric_of(metric).squares_add
        alone = [(row.quantisation, (row.alone / base) ** (2 if powers else 1)) for row in of_metric]
        common = min(share for _, share in alone)
        shares = [(name, share - common) for name, share in alone]
        stacks.append(Stack(metric, base, powers, sorted(shares, key=lambda share: -share[1]), common))
    return stacks


def log_floor(values: Floats) -> float | None:
    """Returns where zeros go on a logarithmic axis: half a decade below the smallest positive value.

    Returns None where the axis is better linear: values below 0, none above, or all within three octaves and no zero.
    """
    finite = values[np.isfinite(values)]
    positive = finite[finite > 0]
    if positive.size == 0 or (finite < 0).any():
        return None
    if positive.max() / positive.min() < 8 and positive.size == finite.size:
        return None
    if positive.max() / positive.min() < 4:  # counts such as 0, 1, 2
        return None
    return float(positive.min() / math.sqrt(10))
