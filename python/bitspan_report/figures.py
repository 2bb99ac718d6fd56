# SPDX-License-Identifier: Apache-2.0
"""Draws the report's plots as SVG and PNG, with matplotlib."""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Iterator, Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, NullFormatter

from . import analysis
from .analysis import Axis, Curve, Floats, Stack
from .study import FIRST_OCTAVE, Bound, Constraint, Register, SearchStep, View

# Okabe and Ito's colours can be told apart with any common colour vision.
BLUE, ORANGE, GREEN, RED, SKY, PINK, YELLOW = (
    "#0072b2",
    "#e69f00",
    "#009e73",
    "#d55e00",
    "#56b4e9",
    "#cc79a7",
    "#f0e442",
)
GREY = "#8a8a8a"
MOST_DRAWN_AS_VECTORS = 3000  # more points of an SVG are one picture in it: vectors would take 0.1 kB per point
STACK_COLOURS = (BLUE, ORANGE, GREEN, PINK, SKY, RED, YELLOW)

matplotlib.rcParams.update(
    {
        "font.family": "DejaVu Sans",
        "font.size": 9,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#e4e4e4",
        "axes.axisbelow": True,
        "axes.titlesize": 9,
        "legend.frameon": False,
        "svg.hashsalt": "bitspan",
        "figure.constrained_layout.use": True,
        "text.parse_math": False,
    }
)


def render(figure: Figure) -> dict[str, bytes]:
    """Returns the figure as {"svg": bytes, "png": bytes}. The same figure gives the same bytes."""
    pictures = {}
    for kind, metadata in (("svg", {"Date": None}), ("png", {"Software": None})):
        buffer = io.BytesIO()
        figure.savefig(buffer, format=kind, dpi=144, metadata=metadata)
        pictures[kind] = buffer.getvalue()
    return pictures


def _figure(width: float, height: float, rows: int = 1, columns: int = 1) -> tuple[Figure, list[Axes]]:
    """Returns a figure of that many inches and its axes, row by row."""
    figure = Figure(figsize=(width, height))
    axes = figure.subplots(rows, columns, squeeze=False)
    return figure, list(axes.flat)


def _set_logarithmic(axes: Axes, vertical: bool) -> None:
    """Makes an axis logarithmic, with ticks in plain text.

    No text of a figure is read as mathematics, because names come from a database.
    """
    (axes.set_yscale if vertical else axes.set_xscale)("log")
    axis = axes.yaxis if vertical else axes.xaxis
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def _scale(axes: Axes, values: Floats, vertical: bool) -> Floats:
    """Returns the values as they are drawn. On a logarithmic axis zeros stand at its foot, which says so."""
    floor = analysis.log_floor(values)
    if floor is None:
        return values
    _set_logarithmic(axes, vertical)
    if (values == 0).any():
        text = axes.axhline if vertical else axes.axvline
        text(floor, color="#c8c8c8", linewidth=0.8, zorder=1)
        axes.annotate(
            "0",
            (0, floor) if vertical else (floor, 0),
            color="#606060",
            fontsize=8,
            ha="right",
            va="center",
            xycoords=("axes fraction", "data") if vertical else ("data", "axes fraction"),
            xytext=(-3, 0) if vertical else (0, 4),
            textcoords="offset points",
        )
    return np.where(values == 0, floor, values)


def _legend_above(axes: Axes, ncol: int = 5, **more: Any) -> None:
    axes.legend(
        loc="lower left",
        bbox_to_anchor=(0, 1),
        fontsize=8,
        ncol=ncol,
        borderaxespad=0.2,
        handletextpad=0.5,
        columnspacing=1.4,
        **more,
    )


def _draw_limits(axes: Axes, constraints: Sequence[Constraint], vertical: bool) -> None:
    scale = axes.get_yscale() if vertical else axes.get_xscale()
    for limit in (limit for constraint in constraints for limit in constraint.limits):
        if scale != "log" or limit > 0:
            (axes.axhline if vertical else axes.axvline)(limit, color=RED, linewidth=1, linestyle="--", zorder=1)


def pareto(
    x_title: str,
    y_title: str,
    costs: Floats,
    errors: Floats,
    holds: Sequence[bool | None],
    front: Sequence[int],
    base: int | None,
    recommended: Sequence[int],
    limits: Sequence[Constraint],
) -> Figure:
    """Draws error against cost, with the limits of the error. costs, errors and holds are (points,); front, base and recommended index them."""
    figure, (axes,) = _figure(7.2, 4.6)
    x, y = _scale(axes, costs, False), _scale(axes, errors, True)
    _draw_limits(axes, limits, True)
    drawable = np.isfinite(x) & np.isfinite(y)
    fails = drawable & np.array([h is False for h in holds], dtype=bool)
    many = int(drawable.sum()) > MOST_DRAWN_AS_VECTORS
    axes.scatter(
        x[drawable & ~fails], y[drawable & ~fails], s=14, color=SKY, label="point", zorder=2, rasterized=many
    )
    if fails.any():
        axes.scatter(
            x[fails],
            y[fails],
            s=16,
            color=GREY,
            marker="x",
            linewidths=0.9,
            label="fails a constraint",
            zorder=2,
            rasterized=many,
        )
    order = list(front)
    if order:
        axes.plot(
            x[order],
            y[order],
            drawstyle="steps-post",
            color=BLUE,
            linewidth=1.4,
            marker="o",
            markersize=4,
            label="Pareto front",
            zorder=3,
        )
    if base is not None and drawable[base]:
        axes.scatter(
            x[[base]], y[[base]], s=60, marker="D", facecolor="none", edgecolor="black", label="base", zorder=4
        )
    chosen = [i for i in recommended if drawable[i]]
    if chosen:
        axes.scatter(
            x[chosen],
            y[chosen],
            s=130,
            marker="*",
            color=ORANGE,
            edgecolor="black",
            linewidths=0.6,
            label="recommended",
            zorder=5,
        )
    axes.set_xlabel(x_title)
    axes.set_ylabel(y_title)
    _legend_above(axes)
    return figure


def curves(
    axes_and_curves: Sequence[tuple[Axis, Curve]], y_title: str, limits: Sequence[Constraint]
) -> Figure:
    """Draws a metric and its limits over the values of each varied key, with one panel per key and knees ringed."""
    columns = min(3, len(axes_and_curves))
    rows = math.ceil(len(axes_and_curves) / columns)
    figure, panels = _figure(3.6 * columns, 2.7 * rows, rows, columns)
    for panel, (axis, drawn) in zip(panels, axes_and_curves):
        values = np.array([s[1] for s in drawn.samples])
        positions = [s[0] for s in drawn.samples] if axis.numeric else list(range(len(values)))
        y = _scale(panel, values, True)
        _draw_limits(panel, limits, True)
        panel.plot(
            positions, y, color=BLUE, marker="o", markersize=4, linewidth=1.3, linestyle="-" if axis.numeric else ""
        )
        if drawn.knee is not None:
            panel.plot(
                positions[drawn.knee],
                y[drawn.knee],
                "o",
                markersize=11,
                markerfacecolor="none",
                markeredgecolor=RED,
                markeredgewidth=1.6,
            )
            panel.annotate(
                f"knee {positions[drawn.knee]:g}",
                (positions[drawn.knee], y[drawn.knee]),
                xytext=(7, 7),
                textcoords="offset points",
                color=RED,
                fontsize=8,
            )
        if axis.numeric:
            if analysis.spans_decades(positions):
                _set_logarithmic(panel, False)
            else:
                panel.xaxis.get_major_locator().set_params(integer=True)
        else:
            crowded = len(positions) > 5
            # Values of several keys that vary together stand below one another, so that neighbours do not meet.
            labels = [str(s[0]) if crowded else str(s[0]).replace(" ", "\n") for s in drawn.samples]
            panel.set_xticks(positions, labels, rotation=90 if crowded else 0)
            panel.tick_params(axis="x", labelsize=6 if crowded else 8)
        panel.set_title(
            "one at a time" if drawn.one_at_a_time else "best of all", fontsize=7, color="#606060", loc="left"
        )
        panel.set_xlabel(textwrap.fill(axis.label, 52), fontsize=8)
    for panel in panels[len(axes_and_curves) :]:
        panel.set_visible(False)
    figure.supylabel(y_title, fontsize=9)
    return figure


def unseen(panels: Sequence[tuple[str, Constraint, Sequence[View]]]) -> Figure:
    """Draws the share of the views that no point was chosen by with at most a value: (title of the axis, constraint, its
    views), one panel each."""
    columns = min(2, len(panels))
    rows = math.ceil(len(panels) / columns)
    figure, drawn = _figure(3.8 * columns, 2.8 * rows, rows, columns)
    for axes, (title, constraint, views) in zip(drawn, panels):
        ordered = analysis.finite_views(views)
        limits = [limit for limit in constraint.limits if math.isfinite(limit)]
        placed = _scale(axes, np.array([*(view.value for view in ordered), *limits]), False)
        x, y = placed[: len(ordered)], 100 * np.arange(1, len(ordered) + 1) / len(views)
        _draw_limits(axes, [constraint], False)
        if len(ordered):
            axes.step([x[0], *x], [0, *y], where="post", color=BLUE, linewidth=1.3)
        for holds, marker, colour, label in ((True, "o", BLUE, "holds"), (False, "x", RED, "fails")):
            at = np.array([view.holds is holds for view in ordered], dtype=bool)
            axes.plot(x[at], y[at], marker, color=colour, markersize=4, label=label, zorder=3)
        axes.set_ylim(0, 105)
        axes.set_title(
            f"{constraint.limits_text}: {analysis.held_text(views)}", fontsize=8, color="#404040", loc="left"
        )
        axes.set_xlabel(textwrap.fill(title, 52), fontsize=8)
    for axes in drawn[len(panels) :]:
        axes.set_visible(False)
    figure.supylabel("views with at most this value [%]", fontsize=9)
    return figure


def octave_bars(register: Register) -> Iterator[tuple[int, int, float]]:
    """Yields the octaves [2^e, 2^(e+1)) with values as (e, count, height 0..1 by the count's logarithm)."""
    top = math.log1p(max(register.octaves, default=0))
    for i, count in enumerate(register.octaves):
        if count:
            yield i + FIRST_OCTAVE, count, math.log1p(count) / top


def histograms(registers: Sequence[Register]) -> Figure:
    """Draws what each register held, by octaves, over the range of its format, and what stays unused at the top."""
    figure, (axes,) = _figure(8.2, 0.9 + 0.27 * len(registers))
    for row, register in enumerate(registers):
        low, high = register.range_log2
        y = len(registers) - 1 - row
        axes.barh(y, high - low, left=low, height=0.92, align="edge", color="#e6eaee", zorder=1)
        if register.headroom > 0 and register.count > register.zeros:
            axes.barh(
                y,
                register.headroom,
                left=high - register.headroom,
                height=0.92,
                align="edge",
                facecolor="#fbe3b5",
                edgecolor="#c98a00",
                hatch="////",
                linewidth=0,
                zorder=2,
            )
        for exponent, _, height in octave_bars(register):
            axes.bar(
                exponent,
                0.88 * height,
                bottom=y,
                width=1,
                align="edge",
                zorder=3,
                color=BLUE if low <= exponent < high else RED,
            )
    axes.set_yticks(
        [len(registers) - 0.55 - row for row in range(len(registers))],
        [f"{r.name}  {r.short_format}" for r in registers],
        fontsize=7,
    )
    axes.set_ylim(0, len(registers))
    axes.grid(False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("log2 |value|, each register in its own unit")
    handles = [
        Patch(color=BLUE, label="values (height: log of the count)"),
        Patch(color="#e6eaee", label="range of the format"),
        Patch(facecolor="#fbe3b5", edgecolor="#c98a00", hatch="////", linewidth=0, label="unused head-room"),
    ]
    _legend_above(axes, handles=handles)
    return figure


def stack_names(stacks: Sequence[Stack], most: int = 6) -> list[str]:
    """Returns the quantisations that matter most over all stacks. Each gets a colour; the others are drawn as one."""
    weight: dict[str, float] = {}
    for stack in stacks:
        total = sum(share for _, share in stack.shares) or 1
        for name, share in stack.shares:
            weight[name] = weight.get(name, 0) + share / total
    return sorted((n for n in weight if weight[n] > 0), key=lambda n: -weight[n])[:most]


def _segments(stacks: Sequence[Stack]) -> Iterator[tuple[str, str, Floats]]:
    """Yields the parts of the budget's bars from left to right: name, colour, (stacks,) lengths in percent."""
    named = stack_names(stacks)
    for colour, name in zip(STACK_COLOURS, named):
        yield name, colour, np.array([100 * sum(v for n, v in stack.shares if n == name) for stack in stacks])
    rest = np.array([100 * sum(v for n, v in stack.shares if n not in named) for stack in stacks])
    if rest.any():
        yield "all others", "#a4a4a4", rest
    common = np.array([100 * stack.common for stack in stacks])
    if (common > 0.1).any():
        yield "common to all", "#e3e8ec", common


def budget(stacks: Sequence[Stack]) -> Figure:
    """Draws the error budget: one bar per metric, with each quantisation's own share of the whole error."""
    figure, (axes,) = _figure(8.2, 1.5 + 0.32 * len(stacks))
    y = np.arange(len(stacks))[::-1]
    left = np.zeros(len(stacks))
    for name, colour, lengths in _segments(stacks):
        axes.barh(
            y, lengths, left=left, height=0.7, color=colour, edgecolor="white", linewidth=0.6, label=name, zorder=2
        )
        left += lengths
    axes.axvline(100, color="black", linewidth=1, zorder=3)
    axes.set_yticks(y, [stack.metric + (" (power)" if stack.powers else "") for stack in stacks], fontsize=8)
    axes.grid(False, axis="y")
    axes.set_xlabel("error with this quantisation alone [% of the whole error; an RMS: of its square]")
    _legend_above(axes, ncol=4)
    return figure


def bounds(rows: Sequence[Bound]) -> Figure:
    """Draws proved bounds beside the largest errors observed. How much of each was reached stands at the right."""
    figure, (axes,) = _figure(7.6, 0.9 + 0.26 * len(rows))
    y = np.arange(len(rows))[::-1]
    bound = np.array([row.bound for row in rows])
    observed = np.array([row.observed for row in rows])
    low, high = np.split(_scale(axes, np.concatenate([observed, bound]), False), 2)
    axes.hlines(y, low, high, color="#b8c4cc", linewidth=2, zorder=1)
    axes.plot(low, y, "o", color=BLUE, markersize=5, label="observed")
    axes.plot(high, y, "|", color="black", markersize=11, markeredgewidth=2, label="proved bound")
    for at, row in zip(y, rows):
        text = "ABOVE ITS BOUND" if row.broken else row.reached
        axes.annotate(
            text,
            (1.01, at),
            xycoords=("axes fraction", "data"),
            va="center",
            fontsize=7,
            color=RED if row.broken else "#404040",
        )
    axes.set_yticks(y, [f"{row.place} [{row.unit}]" if row.unit else row.place for row in rows], fontsize=7)
    axes.grid(False, axis="y")
    axes.set_xlabel("error, each place in its own unit; at the right: observed / bound")
    _legend_above(axes)
    return figure


def search(steps: Sequence[SearchStep], cost_title: str) -> Figure:
    """Draws the cost of each evaluated configuration in order, and the lowest one so far that holds."""
    figure, (axes,) = _figure(7.2, 3.6)
    for holds, marker, colour, label in ((False, "x", GREY, "fails a constraint"), (True, "o", SKY, "holds")):
        some = [step for step in steps if step.holds == holds]
        if some:
            axes.plot(
                [s.number for s in some], [s.cost for s in some], marker, color=colour, markersize=3.5, label=label
            )
    best = best_so_far(steps)
    if best:
        axes.plot(
            [b[0] for b in best],
            [b[1] for b in best],
            drawstyle="steps-post",
            color=BLUE,
            linewidth=1.5,
            label="lowest that holds",
        )
    axes.set_xlabel("evaluation")
    axes.set_ylabel(cost_title)
    _legend_above(axes)
    return figure


def best_so_far(steps: Sequence[SearchStep]) -> list[tuple[int, float]]:
    """Returns (number, cost) wherever a step that holds was cheaper than all before it, and the last step's number."""
    best: list[tuple[int, float]] = []
    for step in steps:
        if step.holds and math.isfinite(step.cost) and (not best or step.cost < best[-1][1]):
            best.append((step.number, step.cost))
    if best and best[-1][0] != steps[-1].number:
        best.append((steps[-1].number, best[-1][1]))
    return best
