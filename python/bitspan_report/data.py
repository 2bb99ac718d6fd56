# SPDX-License-Identifier: Apache-2.0
"""Makes the JSON values that the page's script draws from."""

from __future__ import annotations

import math
from typing import Any

from . import analysis, figures
from .study import Area, BudgetRow, Register, Study


def json_number(value: float) -> float | str | None:
    """Returns a number for JSON: five digits, whole numbers whole, NaN as null, infinities as text."""
    if math.isnan(value):
        return None
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return int(value) if value.is_integer() and abs(value) < 1e12 else float(f"{value:.5g}")


def json_column(values: list[float]) -> Any:
    """Returns a column of the metrics' table, and a single number where all points agree."""
    column = [json_number(v) for v in values]
    if column and isinstance(column[0], (int, float)) and all(v == column[0] for v in column):
        return column[0]
    return column


def config_delta(base: list[str], config: str) -> Any:
    """Returns a configuration as {line number: text} against the base's lines, or whole where lines moved."""
    lines = config.split("\n")
    if len(lines) != len(base):
        return config
    return {str(i): line for i, (line, old) in enumerate(zip(lines, base)) if line != old}


def shown_hashes(study: Study, tables: dict[str, Any]) -> list[str]:
    """Returns the points with rows in a table by hash: the recommended ones first, then the base, then the others."""
    order = [r.hash for r in study.recommended]
    order += [study.points[study.base].hash] if study.base is not None else []
    order += [point.hash for point in study.points]
    return [h for h in dict.fromkeys(order) if h in tables]


def point_name(study: Study, point_hash: str) -> str:
    """Returns a point's name in menus: what it is to the study, and its hash."""
    roles = ["recommended"] if any(r.hash == point_hash for r in study.recommended) else []
    if study.base is not None and study.points[study.base].hash == point_hash:
        roles.append("base")
    return f"{' and '.join(roles) or 'point'} {point_hash[:12]}"


def page_data(study: Study) -> dict[str, Any]:
    """Returns everything that the script draws. It refers to points by their index."""
    x_names, y_names = analysis.cost_metrics(study), analysis.error_metrics(study)
    columns = {n: analysis.column_of(study, n) for n in dict.fromkeys([*x_names, *y_names])}
    lows = {n: analysis.column_to_minimise(study, n) for n in columns}
    axes = analysis.read_axes(study)
    base_lines = study.points[study.base if study.base is not None else 0].config.split("\n") if study.points else []
    return {
        "database": study.database,
        "study": study.name,
        "points": [
            {
                "hash": p.hash,
                "number": p.number,
                "refused": p.refused,
                "message": p.message,
                "settings": p.settings,
                "holds": p.holds,
                "seconds": json_number(p.seconds),
                "config": config_delta(base_lines, p.config),
                "areas": [_area(a) for a in study.areas.get(p.config_hash, [])],
            }
            for p in study.points
        ],
        "baseConfig": base_lines,
        "base": study.base,
        "recommended": [i for r in study.recommended if (i := study.index_of(r.hash)) is not None],
        "metrics": {n: json_column(study.metrics[n]) for n in analysis.told_metrics(study)},
        "units": {n: study.unit_of(n) for n in study.metrics},
        "limits": [{"metric": c.metric, "atMost": c.at_most, "atLeast": c.at_least} for c in study.constraints],
        "x": x_names,
        "y": y_names,
        "fronts": {x: {y: analysis.front_of(study, lows[x], lows[y]) for y in y_names} for x in x_names},
        "axes": [{"label": a.label, "shown": a.shown, "keys": a.keys, "numeric": a.numeric} for a in axes],
        "curves": {y: [_curve(analysis.curve(a, study.metric(y), columns[y])) for a in axes] for y in y_names},
        "registers": {h: [_register(r) for r in study.registers[h]] for h in shown_hashes(study, study.registers)},
        "budget": {h: _budget(study, rows) for h, rows in study.budget.items()},
        "bounds": {
            h: [
                [
                    f"{b.place} [{b.unit}]" if b.unit else b.place,
                    json_number(b.bound),
                    json_number(b.observed),
                    b.reached,
                    b.broken,
                ]
                for b in rows
            ]
            for h, rows in study.bounds.items()
        },
        "steps": [[s.number, json_number(s.cost), s.holds, study.index_of(s.hash)] for s in study.steps],
        "best": figures.best_so_far(study.steps),
        "costTitle": analysis.axis_title(study.metric(study.cost_metric)),
    }


def _area(area: Area) -> dict[str, Any]:
    return {
        "family": area.family,
        "placed": area.placed,
        "status": area.status,
        "message": area.message,
        "values": {n: json_number(v) for n, v in area.values.items() if not math.isnan(v)},
    }


def _curve(curve: analysis.Curve) -> dict[str, Any]:
    return {
        "samples": [[value, json_number(y), i] for value, y, i in curve.samples],
        "knee": curve.knee,
        "oneAtATime": curve.one_at_a_time,
    }


def _register(r: Register) -> dict[str, Any]:
    low, high = r.range_log2
    return {
        "name": r.name,
        "format": r.format,
        "low": low,
        "high": high,
        "headroom": r.headroom,
        "zeros": r.zeros,
        "count": r.count,
        "min": json_number(r.min),
        "max": json_number(r.max),
        "wraps": r.wraps,
        "saturations": r.saturations,
        "bars": [[e, count, round(height, 3)] for e, count, height in figures.octave_bars(r)],
    }


def _budget(study: Study, rows: list[BudgetRow]) -> dict[str, Any]:
    stacks = analysis.budget_stacks(study.metric, rows)
    return {
        "names": figures.stack_names(stacks),
        "stacks": [
            {
                "metric": s.metric,
                "powers": s.powers,
                "common": json_number(s.common),
                "shares": [[n, json_number(v)] for n, v in s.shares if v],
            }
            for s in stacks
        ],
    }
