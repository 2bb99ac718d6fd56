# SPDX-License-Identifier: Apache-2.0
"""Compares a study with another one: what moved, and what it bought."""

from __future__ import annotations

import json
import math
from html import escape
from typing import Any

from . import analysis
from .markup import note, or_dash, point_link, section, table
from .study import Point, Study

MOST_POINTS = 200  # of a table of points that changed


def comparison(study: Study, other: Study) -> str:
    """Returns the section of the page that compares the study with the other, which is called "before"."""
    parts = [
        f"<p>Before: study <b>{escape(other.name)}</b> of <code>{escape(other.database)}</code>. "
        f"Now: <b>{escape(study.name)}</b> of <code>{escape(study.database)}</code>.</p>",
        "<h3>Constraints</h3>",
        _constraints(study, other),
    ]
    before = {_kind(found.reason): found.hash for found in other.recommended}
    for found in study.recommended:
        parts.append(f"<h3>{point_link(study, found.hash).markup} {escape(found.reason)}</h3>")
        old = before.pop(_kind(found.reason), None)
        indices = study.index_of(found.hash), other.index_of(old) if old else None
        if indices[0] is None or indices[1] is None:
            parts.append(note("The study before recommends no such point."))
        else:
            parts.append(_moved(study, indices[0], other, indices[1]))
    parts += [note(f"No longer recommended: {kind} ({h[:12]}).") for kind, h in before.items()]
    return section("compared", "Compared with another study", "".join(parts) + _changed_points(study, other))


def _kind(reason: str) -> str:
    """Returns what a point is recommended for, without the numbers behind it."""
    return reason.partition(":")[0]


def _constraints(study: Study, other: Study) -> str:
    lines = [str(c) for c in study.constraints], [str(c) for c in other.constraints]
    moved = [("only now", line) for line in lines[0] if line not in lines[1]]
    moved += [("only before", line) for line in lines[1] if line not in lines[0]]
    return table(["", "constraint"], moved) if moved else note("Both studies have the same constraints.")


def _all_settings(study: Study, index: int) -> dict[str, Any]:
    return {**study.base_settings, **study.points[index].settings}


def _moved(study: Study, index: int, other: Study, old: int) -> str:
    """Returns the settings of two points that differ, and their costs and errors with the differences."""
    now, before = _all_settings(study, index), _all_settings(other, old)
    settings = [
        (key, or_dash(before.get(key)), or_dash(now.get(key)))
        for key in dict.fromkeys([*before, *now])
        if before.get(key) != now.get(key)
    ]
    names = [*analysis.cost_metrics(study), *(c.metric for c in study.constraints), *analysis.error_metrics(study)]
    rows = []
    for name in dict.fromkeys(names):
        if name in study.metrics and name in other.metrics:
            new, was = float(study.metrics[name][index]), float(other.metrics[name][old])
            rows.append((name, study.unit_of(name), was, new, _difference(new, was), _percent(new, was)))
    missing = [name for name in dict.fromkeys(names) if name not in other.metrics]
    parts = [table(["setting", "before", "now"], settings) if settings else note("The same settings.")]
    parts.append(table(["metric", "unit", "before", "now", "difference", "in %"], rows, scroll=len(rows) > 14))
    if missing:
        parts.append(note("Not measured before: " + ", ".join(missing)))
    return '<div class="beside">' + "".join(f"<div>{part}</div>" for part in parts) + "</div>"


def _difference(now: float, before: float) -> float:
    return 0.0 if now == before else now - before


def _percent(now: float, before: float) -> float:
    """Returns NaN, which is drawn as a dash, where no percentage says anything."""
    if now == before:
        return 0.0
    return 100 * (now - before) / abs(before) if before and math.isfinite(before) and math.isfinite(now) else math.nan


def _changed_points(study: Study, other: Study) -> str:
    """Returns the points that both studies judge, by the keys that they set, and that hold in one of them alone."""
    before = {_identity(point): point for point in other.points if point.number is not None}
    both = [(point, before[_identity(point)]) for point in study.points
            if point.number is not None and _identity(point) in before]  # fmt: skip
    judged = [(now, was) for now, was in both if now.holds is not None and was.holds is not None]
    changed = [(now, was) for now, was in judged if now.holds != was.holds]
    rows = [
        (point_link(study, now.hash), ", ".join(f"{k} = {v}" for k, v in now.settings.items()) or "as the base",
         "holds" if was.holds else "fails", "holds" if now.holds else "fails")
        for now, was in changed[:MOST_POINTS]
    ]  # fmt: skip
    text = f"{len(both)} points set the same keys to the same values in both studies, and {len(judged)} of them are judged in both. "
    text += f"{sum(bool(was.holds) for _, was in changed)} went from holding to failing, "
    text += f"{sum(bool(now.holds) for now, _ in changed)} from failing to holding."
    if len(changed) > MOST_POINTS:
        text += f" The first {MOST_POINTS} are listed."
    listed = table(["point", "settings", "before", "now"], rows, scroll=len(rows) > 12) if rows else ""
    return f"<h3>Points that changed</h3>{note(text)}{listed}"


def _identity(point: Point) -> str:
    return json.dumps(point.settings, sort_keys=True)
