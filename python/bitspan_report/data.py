# SPDX-License-Identifier: Apache-2.0
"""Makes the JSON values that the page's script draws from."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import analysis, figures
from .study import Area, BudgetRow, Constraint, Register, Study, View


def json_number(value: float) -> float | str | None:
    """Returns a number for JSON: five digits, whole numbers whole, NaN as null, infinities as text."""
    if math.isnan(value):
        return None
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return int(value) if value.is_integer() and abs(value) < 1e12 else float(f"{value:.5g}")


METRICS_ROOM = 12_000_000  # bytes of the page for the columns of metrics; those beyond are named there

_SCRIPT_ARRAYS = {
    "|u1": "Uint8Array",
    "|i1": "Int8Array",
    "<u2": "Uint16Array",
    "<i4": "Int32Array",
    "<f4": "Float32Array",
    "<f8": "Float64Array",
}


def packed(values: NDArray[Any]) -> dict[str, str]:
    """Returns an array as the script unpacks it: the name of its typed array, and the bytes in base 64."""
    little = values.astype(values.dtype.newbyteorder("<"), copy=False)
    return {"array": _SCRIPT_ARRAYS[little.dtype.str], "bytes": base64.b64encode(little.tobytes()).decode()}


def _packed_indices(indices: NDArray[Any], count: int) -> dict[str, str]:
    kind = np.uint8 if count <= 1 << 8 else np.uint16 if count <= 1 << 16 else np.int32
    return packed(indices.astype(kind))


def packed_column(values: NDArray[np.float64]) -> dict[str, Any]:
    """Returns a column of the metrics' table: one number, its different values with an index per point, or floats.

    The script gets all 53 bits of a number but in the last case, where a column has too many different values for a
    table of them to be shorter. It has 24 bits of them.
    """
    table, indices = np.unique(values, return_inverse=True)
    if table.size == 1:
        return {"table": packed(table)}
    if table.size <= 1 << 16 and 8 * table.size + (1 if table.size <= 1 << 8 else 2) * values.size <= 4 * values.size:
        return {"table": packed(table), "at": _packed_indices(indices, table.size)}
    return {"table": packed(values.astype(np.float32)), "at": None}


def packed_texts(values: Iterable[Any]) -> dict[str, Any]:
    """Returns a column of texts, numbers or None as its different values and an index per point."""
    table: dict[Any, int] = {}  # by type too: 1, 1.0 and True are one key of a dictionary
    indices = [table.setdefault((type(v), v), len(table)) for v in values]
    return {"table": [value for _, value in table], "at": _packed_indices(np.array(indices), len(table))}


def packed_hashes(hashes: Sequence[str]) -> dict[str, Any]:
    """Returns the hashes' bytes one after the other, and the hashes as they are where one is not hexadecimal."""
    digits = len(hashes[0]) if hashes else 0
    if digits % 2 or any(len(h) != digits or h.strip("0123456789abcdef") for h in hashes):
        return {"texts": list(hashes)}
    return {"digits": digits, **packed(np.frombuffer(bytes.fromhex("".join(hashes)), dtype=np.uint8))}


def told_columns(study: Study, room: int = METRICS_ROOM) -> tuple[dict[str, Any], list[str]]:
    """Returns the columns of the metrics that the page tells, the drawn ones first, and the names that found no room.

    What a constraint judges on its worst scene has that scene's name per point beside it.
    """
    drawn = dict.fromkeys([*analysis.cost_metrics(study)[:1], *analysis.error_metrics(study), *analysis.cost_metrics(study)])
    columns: dict[str, Any] = {}
    left_out = []
    for name in dict.fromkeys([*drawn, *analysis.told_metrics(study)]):
        column = packed_column(study.metrics[name])
        if name in study.worst_scenes:
            column["scene"] = packed_texts(study.worst_scenes[name])
        room -= len(json.dumps(column))
        if room < 0:
            left_out.append(name)
        else:
            columns[name] = column
    return {n: columns[n] for n in study.metrics if n in columns}, left_out


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


def page_data(study: Study, axes: Sequence[analysis.Axis]) -> dict[str, Any]:
    """Returns everything that the script draws. It refers to points by their index, and has them column by column."""
    columns, left_out = told_columns(study)
    x_names = [n for n in analysis.cost_metrics(study) if n in columns]
    y_names = [n for n in analysis.error_metrics(study) if n in columns]
    keys = dict.fromkeys(key for p in study.points for key in p.settings)
    base_lines = study.points[study.base if study.base is not None else 0].config.split("\n") if study.points else []
    return {
        "database": study.database,
        "study": study.name,
        "count": len(study.points),
        "hashes": packed_hashes([p.hash for p in study.points]),
        "numbers": packed(np.array([-1 if p.number is None else p.number for p in study.points], dtype=np.int32)),
        "holds": packed(np.array([-1 if p.holds is None else p.holds for p in study.points], dtype=np.int8)),
        "refusals": packed_texts(p.message if p.refused else None for p in study.points),
        "settings": {key: packed_texts(p.settings.get(key) for p in study.points) for key in keys},
        "configs": {i: config_delta(base_lines, p.config) for i, p in enumerate(study.points) if p.config},
        "areas": {
            i: [_area(a) for a in study.areas[p.config_hash]]
            for i, p in enumerate(study.points)
            if p.config_hash in study.areas
        },
        "baseConfig": base_lines,
        "base": study.base,
        "recommended": [i for r in study.recommended if (i := study.index_of(r.hash)) is not None],
        "metrics": columns,
        "leftOut": left_out,
        "high": [n for n in columns if study.metric(n).high],
        "units": {n: study.unit_of(n) for n in columns},
        "limits": [{"text": str(c), "metric": c.judged, "limits": c.limits} for c in study.constraints],
        "x": x_names,
        "y": y_names,
        "axes": [{"label": a.label, "shown": a.shown, "keys": a.keys, "numeric": a.numeric} for a in axes],
        "curves": {y: [_curve(analysis.curve(a, study.metric(y), study.metrics[y])) for a in axes] for y in y_names},
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
        "unseen": {h: [_unseen(*panel) for panel in analysis.unseen_panels(study, h)] for h in study.validation},
        "steps": [[s.number, json_number(s.cost), s.holds, study.index_of(s.hash)] for s in study.steps],
        "best": figures.best_so_far(study.steps),
        "costTitle": analysis.axis_title(study.metric(study.cost_metric)),
    }


def _area(area: Area) -> dict[str, Any]:
    return {
        "name": area.name,
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


def _unseen(title: str, constraint: Constraint, views: list[View]) -> dict[str, Any]:
    drawn = [[v.scene, json_number(v.value), v.holds] for v in analysis.finite_views(views)]
    return {"title": title, "limits": constraint.limits, "count": len(views), "views": drawn}


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
