# SPDX-License-Identifier: Apache-2.0
"""Reads one study out of a study database (SQLite, schema 4)."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import pathlib
import re
import sqlite3
from collections import defaultdict
from collections.abc import Iterator
from contextlib import closing
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import ReportError, analysis, expression
from .study import (
    Area,
    Bound,
    BudgetRow,
    Cause,
    CertificateRow,
    Combination,
    Constraint,
    FieldError,
    MeasuredCost,
    Metric,
    Point,
    Recommendation,
    Register,
    SearchStep,
    Study,
    Varied,
    View,
    listed_scenes,
)

SCHEMA = "4"

# Selects the points that a study refers to anywhere; :s is its name.
_POINTS = """(SELECT hash FROM study_points WHERE study = :s UNION SELECT hash FROM search_steps WHERE study = :s
  UNION SELECT hash FROM certificate WHERE study = :s UNION SELECT hash FROM recommended WHERE study = :s
  UNION SELECT base_hash FROM studies WHERE name = :s)"""


class _Reader:
    """Queries of one study, in one transaction, so that a study that runs on meanwhile does not mix two states."""

    def __init__(self, connection: sqlite3.Connection, study: str) -> None:
        self._connection = connection
        self._study = study

    def rows(self, query: str, **values: str) -> Iterator[tuple[Any, ...]]:
        """Returns the rows of a query in which :s is the study's name."""
        return iter(self._connection.execute(query, {"s": self._study, **values}))

    def rows_if_there(self, table: str, query: str) -> Iterator[tuple[Any, ...]]:
        """Returns the same of a table that databases of an earlier bitspan lack."""
        there = self._connection.execute("SELECT 1 FROM sqlite_master WHERE name = ?", (table,)).fetchone()
        return self.rows(query) if there else iter(())


def number(value: Any) -> float:
    """Returns a stored number. NULL is NaN, and infinities are text."""
    return math.nan if value is None else float(value)


def load_other(path: str, name: str | None, same: str) -> Study:
    """Returns the study to compare with: of that name, or without one the one called `same`, or the only one there is.

    Throws ReportError.
    """
    return load_study(path, name, option="--against-study", preferred=same)


def load_study(path: str, name: str | None, option: str = "--study", preferred: str | None = None) -> Study:
    """Returns the study of that name, or without a name the only one there is. Throws ReportError."""
    if not pathlib.Path(path).is_file():
        raise ReportError(f"{path}: no such file")
    try:
        with closing(
            sqlite3.connect(_uri_of(pathlib.Path(path).absolute()), uri=True, timeout=5, isolation_level=None)
        ) as connection:
            connection.execute("PRAGMA temp_store = MEMORY")  # reading needs no room on any disk
            connection.execute("BEGIN")
            version = _check_schema(path, connection)
            study = _select_study(path, connection, name, option, preferred)
            return _read(path, version, _Reader(connection, study), study)
    except sqlite3.Error as error:
        raise ReportError(f"{path}: cannot be read as a study database: {error}") from None
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise ReportError(f"{path}: holds a value that no study writes: {error}") from None


def _uri_of(path: pathlib.Path) -> str:
    """Returns the address of the file for reading alone.

    SQLite puts a file beside one with a write-ahead log, but does without in a folder where it cannot. A file without a
    log has no writer, so nothing changes meanwhile.
    """
    still = not os.access(path.parent, os.W_OK) and not pathlib.Path(f"{path}-wal").exists()
    return path.as_uri() + ("?mode=ro&immutable=1" if still else "?mode=ro")


def _check_schema(path: str, connection: sqlite3.Connection) -> str:
    tables = {row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type IN ('table', 'view')")}
    if not {"meta", "studies", "points"} <= tables:
        raise ReportError(f"{path}: not a study database: it has no tables meta, studies, points")
    meta = dict(connection.execute("SELECT key, value FROM meta"))
    if str(meta.get("schema")) != SCHEMA:
        raise ReportError(f"{path}: schema {meta.get('schema')}; expected {SCHEMA}")
    return str(meta.get("version", ""))


def _select_study(
    path: str, connection: sqlite3.Connection, name: str | None, option: str, preferred: str | None
) -> str:
    names = [row[0] for row in connection.execute("SELECT name FROM studies ORDER BY name")]
    listed = ", ".join(names) or "none"
    if name is not None and name not in names:
        raise ReportError(f'{path}: no study "{name}"; it has: {listed}')
    if name is None and preferred in names:
        return str(preferred)
    if name is None and len(names) != 1:
        raise ReportError(f"{path}: {len(names)} studies; name one with {option}, of: {listed}")
    return name if name is not None else names[0]


def _read(path: str, version: str, reader: _Reader, name: str) -> Study:
    plan, kind, base_hash, cost = next(reader.rows("SELECT plan, kind, base_hash, cost FROM studies WHERE name = :s"))
    points = _read_points(reader, base_hash)
    axes, base_settings = _read_axes(reader)
    findings: dict[str, list[str]] = defaultdict(list)
    for h, line in reader.rows("SELECT hash, line FROM findings WHERE study = :s ORDER BY rowid"):
        findings[h].append(line)
    indices = {point.hash: i for i, point in enumerate(points)}
    study = Study(
        database=pathlib.Path(path).name,
        version=version,
        name=name,
        kind=kind,
        plan=plan,
        points=points,
        base=indices.get(base_hash),
        metrics=_read_metrics(reader, indices),
        scenes=_read_scenes(reader),
        worst_scenes={},
        known=_read_known_metrics(reader),
        axes=axes,
        base_settings=base_settings if base_hash in indices else dict.fromkeys(base_settings),
        constraints=[
            Constraint(*row)
            for row in reader.rows(
                "SELECT metric, at_most, at_least, over = 'pooled' FROM constraints WHERE study = :s ORDER BY i"
            )
        ],
        chosen_metrics=[row[0] for row in reader.rows("SELECT name FROM study_metrics WHERE study = :s ORDER BY i")],
        cost_metric=cost,
        errors=_read_errors(reader),
        registers={},
        budget=_read_budget(reader),
        bounds=_read_bounds(reader),
        pictures=_read_pictures(reader),
        causes=_read_causes(reader),
        areas=_read_areas(reader),
        steps=[
            SearchStep(i, h, number(cost), bool(holds), bool(best))
            for i, h, cost, holds, best in reader.rows(
                "SELECT i, hash, cost, holds, best FROM search_steps WHERE study = :s ORDER BY i"
            )
        ],
        certificate=[
            CertificateRow(*(str(v or "") for v in row))
            for row in reader.rows(
                "SELECT key, from_value, to_value, hash, failed, combination FROM certificate "
                "WHERE study = :s ORDER BY rowid"
            )
        ],
        combinations=[
            Combination(name, h, number(cost), evaluations, stopped_by, bool(minimal), failing)
            for name, h, cost, evaluations, stopped_by, minimal, failing in reader.rows(
                "SELECT combination, hash, cost, evaluations, stopped_by, minimal, failing FROM combinations "
                "WHERE study = :s ORDER BY i"
            )
        ],
        measured_costs=[
            MeasuredCost(h, number(estimated), number(error), number(measured), message or "")
            for h, estimated, error, measured, message in reader.rows_if_there(
                "measured_costs",
                "SELECT hash, estimated, error, measured, message FROM measured_costs WHERE study = :s ORDER BY i",
            )
        ],
        recommended=[
            Recommendation(h, reason or "", verified or "", findings.get(h, []))
            for h, reason, verified in reader.rows(
                "SELECT hash, reason, verified FROM recommended WHERE study = :s ORDER BY rowid"
            )
        ],
        validation=_read_validation(reader),
    )
    _add_area_metrics(study)
    _add_expressions(study, reader)
    _add_worst_scenes(study, reader)
    study.metrics = dict(sorted(study.metrics.items()))
    study.registers = _read_registers(reader, analysis.noted_points(study))
    return study


def _read_points(reader: _Reader, base_hash: str) -> list[Point]:
    points: dict[str, Point] = {}
    for h, config_hash, config, scenes, status, message, seconds in reader.rows(
        "SELECT hash, config_hash, config, scenes, status, message, seconds FROM points "
        f"WHERE hash IN {_POINTS} ORDER BY hash"
    ):
        points[h] = Point(h, config_hash, config or "", scenes or "", status != "ok", message or "", number(seconds))
    for i, h, settings, holds in reader.rows(
        "SELECT i, hash, settings, holds FROM study_points WHERE study = :s ORDER BY i"
    ):
        point = points.get(h)
        if point is None or point.number is not None:  # not computed yet, or the same configuration again
            continue
        point.number, point.settings = i, dict(json.loads(settings))
        point.holds = None if holds is None else bool(holds)
    for h, settings in reader.rows("SELECT hash, settings FROM certificate WHERE study = :s"):
        if h in points and points[h].number is None and h != base_hash:
            points[h].settings = dict(json.loads(settings))
    for h, holds in reader.rows("SELECT hash, holds FROM search_steps WHERE study = :s"):
        if h in points and points[h].holds is None:
            points[h].holds = bool(holds)
    return sorted(points.values(), key=lambda point: math.inf if point.number is None else point.number)


def _read_axes(reader: _Reader) -> tuple[list[Varied], dict[str, Any]]:
    """Returns the keys that vary, those set together in one, and what the base has for each, None for none."""
    axes: dict[int, Varied] = {}
    base: dict[str, Any] = {}
    query = 'SELECT axis, key, base, name, "offset" FROM axes WHERE study = :s ORDER BY axis, i'
    for axis, key, value, name, offset in reader.rows(query):
        varied = axes.setdefault(axis, Varied(name or "", [], []))
        varied.keys.append(key)
        varied.offsets.append(offset or 0)
        base[key] = None if value is None else json.loads(value)
    return list(axes.values()), base


def _read_metrics(reader: _Reader, indices: dict[str, int]) -> dict[str, NDArray[np.float64]]:
    columns: dict[str, NDArray[np.float64]] = defaultdict(lambda: _no_values(len(indices)))
    for h, name, value in reader.rows(f"SELECT hash, name, value FROM metrics WHERE hash IN {_POINTS}"):
        if h in indices:
            columns[name][indices[h]] = number(value)
    return columns


def _no_values(count: int) -> NDArray[np.float64]:
    return np.full(count, math.nan)


def _read_scenes(reader: _Reader) -> dict[str, dict[str, dict[str, float]]]:
    """Returns, for recommended points and the base, the metrics of each scene by its name, in the scenes' order."""
    wanted = "(SELECT hash FROM recommended WHERE study = :s UNION SELECT base_hash FROM studies WHERE name = :s)"
    found: dict[str, dict[str, dict[str, float]]] = {}
    for h, scenes in reader.rows(f"SELECT hash, scenes FROM points WHERE hash IN {wanted}"):
        names = _scene_names(scenes or "")
        rows: dict[str, dict[str, float]] = {name: {} for name in names}
        for scene, name, value in reader.rows(
            "SELECT scene, name, value FROM scene_metrics WHERE hash = :h ORDER BY scene", h=h
        ):
            if scene < len(names):
                rows[names[scene]][name] = number(value)
        found[h] = rows
    return found


def _scene_names(scenes: str) -> list[str]:
    return [str(scene.get("name", "")) for scene in listed_scenes(scenes) or [] if isinstance(scene, dict)]


def _read_known_metrics(reader: _Reader) -> dict[str, Metric]:
    return {
        name: Metric(name, field, label, unit, better == "high", role, bool(squares_add), meaning)
        for name, field, label, unit, better, role, squares_add, meaning in reader.rows(
            "SELECT name, field, label, unit, better, role, squares_add, meaning FROM known_metrics ORDER BY i"
        )
    }


def _read_errors(reader: _Reader) -> dict[str, list[FieldError]]:
    errors: dict[str, list[FieldError]] = defaultdict(list)
    for h, stage, quantity, unit, ulp, count in reader.rows(
        "SELECT hash, stage, quantity, unit, ulp, count FROM fields "
        "WHERE hash IN (SELECT hash FROM recommended WHERE study = :s UNION "
        "SELECT base_hash FROM studies WHERE name = :s) ORDER BY rowid"
    ):
        errors[h].append(FieldError(stage, quantity, unit or "", number(ulp), count))
    return dict(errors)


def _read_registers(reader: _Reader, hashes: list[str]) -> dict[str, list[Register]]:
    registers: dict[str, list[Register]] = {}
    for h in hashes:
        found = [
            _register(*row)
            for row in reader.rows(
                'SELECT name, format, word, "int", signed, count, min, max, used_bits, headroom, wraps, '
                "saturations, zeros, octaves "
                "FROM registers WHERE hash = :h ORDER BY rowid",
                h=h,
            )
        ]
        if found:
            registers[h] = found
    return registers


def _register(
    name: str,
    text: str,
    word: int,
    integer: int,
    signed: int,
    count: int,
    low: Any,
    high: Any,
    used: int,
    headroom: int,
    wraps: int,
    saturations: int,
    zeros: int,
    octaves: str,
) -> Register:
    counts = [int(c) for c in json.loads(octaves)]
    if len(counts) != 128:
        raise ValueError(f"octaves of register {name}: {len(counts)} counts; expected 128")
    return Register(
        name,
        text,
        word,
        integer,
        bool(signed),
        count,
        number(low),
        number(high),
        used,
        headroom,
        wraps,
        saturations,
        zeros,
        counts,
    )


def _read_validation(reader: _Reader) -> dict[str, dict[int, list[View]]]:
    validation: dict[str, dict[int, list[View]]] = {}
    query = (
        "SELECT hash, i, scene, value, holds FROM validation WHERE study = :s "
        "AND i IN (SELECT i FROM constraints WHERE study = :s) ORDER BY hash, i, rowid"
    )
    for h, i, scene, value, holds in reader.rows(query):
        validation.setdefault(h, {}).setdefault(i, []).append(View(scene, number(value), bool(holds)))
    return validation


def _read_budget(reader: _Reader) -> dict[str, list[BudgetRow]]:
    budget: dict[str, list[BudgetRow]] = defaultdict(list)
    for h, quantisation, metric, base, without, alone in reader.rows(
        f"SELECT hash, quantisation, metric, base, without, alone FROM budget WHERE hash IN {_POINTS} ORDER BY rowid"
    ):
        budget[h].append(BudgetRow(quantisation, metric, number(base), number(without), number(alone)))
    return dict(budget)


def _read_bounds(reader: _Reader) -> dict[str, list[Bound]]:
    bounds: dict[str, list[Bound]] = defaultdict(list)
    for h, place, unit, bound, observed in reader.rows(
        f"SELECT hash, place, unit, bound, observed FROM bounds WHERE hash IN {_POINTS} ORDER BY rowid"
    ):
        bounds[h].append(Bound(place, unit or "", number(bound), number(observed)))
    return dict(bounds)


def _read_pictures(reader: _Reader) -> dict[str, dict[str, dict[str, bytes]]]:
    pictures: dict[str, dict[str, dict[str, bytes]]] = {}
    for h, scene, name, png in reader.rows(
        f"SELECT hash, scene, name, png FROM pictures WHERE hash IN {_POINTS} ORDER BY rowid"
    ):
        if not isinstance(png, bytes) or not png.startswith(b"\x89PNG\r\n\x1a\n"):
            raise ValueError(f'picture "{name}" of scene "{scene}" is no PNG')
        pictures.setdefault(h, {}).setdefault(scene, {})[name] = png
    return pictures


def _read_causes(reader: _Reader) -> dict[str, dict[str, list[Cause]]]:
    causes: dict[str, dict[str, list[Cause]]] = {}
    for h, scene, name, colour, pixels in reader.rows(
        f"SELECT hash, scene, name, color, pixels FROM causes WHERE hash IN {_POINTS} ORDER BY hash, scene, i"
    ):
        if not re.fullmatch(r"#[0-9a-f]{6}", colour):
            raise ValueError(f"colour of cause {name}: {colour}; expected #rrggbb")
        causes.setdefault(h, {}).setdefault(scene, []).append(Cause(name, colour, pixels))
    return causes


_AREA_COLUMNS = ("luts", "ffs", "multipliers", "memory_bits", "fmax_mhz")


_AREA_PARTS = ("", "pixel_", "late_pixel_")  # as the names of their tables and metrics have them in front


def _read_areas(reader: _Reader) -> dict[str, list[Area]]:
    areas: dict[str, list[Area]] = defaultdict(list)
    for part in _AREA_PARTS:
        table = f"{part}areas"
        for config_hash, family, placed, status, message, tools, *values in reader.rows_if_there(
            table,
            "SELECT config_hash, family, placed, status, message, tools, luts, ffs, multipliers, memory_bits, fmax_mhz "
            f"FROM {table} WHERE config_hash IN (SELECT config_hash FROM points WHERE hash IN {_POINTS}) "
            "ORDER BY family, placed",
        ):
            counts = dict(zip(_AREA_COLUMNS, map(number, values)))
            areas[config_hash].append(Area(family, part, bool(placed), status, message or "", counts, tools or ""))
    return dict(areas)


def _add_expressions(study: Study, reader: _Reader) -> None:
    """Adds the expressions of the plan as metrics by their text; the cost is one of the costs, the others are results."""
    at_least = {c.metric for c in study.constraints if c.at_most is None}
    texts = dict.fromkeys([study.cost_metric, *(c.metric for c in study.constraints)])
    indices = {point.hash: i for i, point in enumerate(study.points)}
    for h, text, value in reader.rows(f"SELECT hash, text, value FROM expressions WHERE hash IN {_POINTS}"):
        if h not in indices or text not in texts:
            continue
        role = "cost" if text == study.cost_metric else "result"
        study.known.setdefault(text, Metric(text, "", "", "", text in at_least, role, False, "expression of the plan"))
        study.metrics.setdefault(text, _no_values(len(study.points)))[indices[h]] = number(value)


def _add_worst_scenes(study: Study, reader: _Reader) -> None:
    """Adds a metric for each constraint that judges the worst of several scenes, with what it judges at each point."""
    known_names = {text: _scene_names(text) for text in {point.scenes for point in study.points}}
    names = [known_names[point.scenes] for point in study.points]
    judging = [c for c in study.constraints if not c.pooled]
    if max(map(len, names), default=0) < 2:
        return
    scenes = _read_scene_columns(study, reader, {n for c in judging for n in expression.metrics_of(c.metric)}, names)
    for constraint in judging:
        of_scenes = analysis.scene_column(constraint.metric, scenes, study.metrics)
        if of_scenes is None or constraint.metric not in study.metrics:
            continue
        name = f"{constraint.metric}, worst scene"
        constraint.judged = name if name not in study.metrics else f"{name}, {constraint.limits_text}"
        known = study.metric(constraint.metric)
        study.known[constraint.judged] = dataclasses.replace(
            known, name=constraint.judged, field="", label="", role="result"
        )
        values, deciding = analysis.decisive(constraint, of_scenes, study.metrics[constraint.metric])
        study.metrics[constraint.judged] = values
        study.worst_scenes[constraint.judged] = [own[i] if i >= 0 else "" for own, i in zip(names, deciding)]


def _read_scene_columns(
    study: Study, reader: _Reader, metrics: set[str], names: list[list[str]]
) -> dict[str, analysis.SceneColumn]:
    """Returns the metrics of each scene alone; names has those of each point's scenes."""
    shape = (max(map(len, names)), len(names))
    columns: dict[str, analysis.SceneColumn] = {}
    for metric in sorted(metrics):
        query = f"SELECT hash, scene, value FROM scene_metrics WHERE name = :n AND hash IN {_POINTS}"
        for h, scene, value in reader.rows(query, n=metric):
            index = study.index_of(h)
            if index is None or scene >= len(names[index]):
                continue
            if metric not in columns:
                columns[metric] = analysis.SceneColumn(np.full(shape, math.nan), np.zeros(shape, dtype=bool))
            columns[metric].values[scene, index] = number(value)
            columns[metric].there[scene, index] = True
    return columns


def _add_area_metrics(study: Study) -> None:
    """Adds synthesis results as metrics: area.FAMILY.luts ... Where both were run, it takes those after placement."""
    for i, point in enumerate(study.points):
        for area in study.areas.get(point.config_hash, []):
            for column, value in area.values.items():
                if area.status == "ok" and not math.isnan(value):
                    name = f"area.{area.family}.{area.part}{column}"
                    study.metrics.setdefault(name, _no_values(len(study.points)))[i] = value
