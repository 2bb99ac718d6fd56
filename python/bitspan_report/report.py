# SPDX-License-Identifier: Apache-2.0
"""Writes the report's files: the page, the plots, the pictures."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from plotly.offline import get_plotlyjs

from . import analysis, data, figures, files
from .compare import comparison
from .page import page
from .study import Study


def write_report(study: Study, folder: str, against: Study | None = None) -> None:
    """Writes the report of a study into the folder, report.html last, compared with another study. Throws ReportError."""
    content = {**plots(study), **pictures(study)}
    content["report.html"] = page(study, get_plotlyjs(), comparison(study, against) if against else "").encode("utf-8")
    files.write_all(folder, content)


def _file_name(*parts: str) -> str:
    """Returns the parts as a file name of letters, digits, dots, dashes."""
    return "-".join(re.sub(r"[^A-Za-z0-9._]+", "_", part).strip("._") or "_" for part in parts)


def _both(name: str, figure: Figure) -> dict[str, bytes]:
    return {f"{name}.{kind}": content for kind, content in figures.render(figure).items()}


def plots(study: Study) -> dict[str, bytes]:
    """Returns {file name: bytes} of every plot, SVG and PNG. Those of one configuration have its hash in the name."""
    content: dict[str, bytes] = {}
    costs, errors = analysis.cost_metrics(study), analysis.error_metrics(study)
    if any(not p.refused for p in study.points) and costs and errors:
        content |= _pareto(study, costs[0], errors[0])
        content |= _curves(study, errors[0])
    if study.steps:
        content |= _both("search", figures.search(study.steps, analysis.axis_title(study.metric(study.cost_metric))))
    for h in _drawn(study, study.registers):
        content |= _both(_file_name("registers", h[:12]), figures.histograms(study.registers[h]))
    for h in _drawn(study, study.budget):
        stacks = analysis.budget_stacks(study.metric, study.budget[h])
        if stacks:
            content |= _both(_file_name("budget", h[:12]), figures.budget(stacks))
    for h in _drawn(study, study.bounds):
        content |= _both(_file_name("bounds", h[:12]), figures.bounds(study.bounds[h]))
    for h in _drawn(study, study.validation):
        content |= _both(_file_name("unseen", h[:12]), figures.unseen(analysis.unseen_panels(study, h)))
    return content


def _drawn(study: Study, tables: dict[str, Any]) -> list[str]:
    """Returns the configurations that get files: the recommended ones and the base; without either, the first."""
    wanted = {r.hash for r in study.recommended}
    if study.base is not None:
        wanted.add(study.points[study.base].hash)
    with_rows = data.shown_hashes(study, tables)
    return [h for h in with_rows if h in wanted] or with_rows[:1]


def _pareto(study: Study, x: str, y: str) -> dict[str, bytes]:
    cost, error = study.metrics[x], study.metrics[y]
    front = analysis.front_of(study, analysis.column_to_minimise(study, x), analysis.column_to_minimise(study, y))
    recommended = [i for r in study.recommended if (i := study.index_of(r.hash)) is not None]
    figure = figures.pareto(
        analysis.axis_title(study.metric(x)),
        analysis.axis_title(study.metric(y)),
        cost,
        error,
        [p.holds for p in study.points],
        front,
        study.base,
        recommended,
        [c for c in study.constraints if c.judged == y],
    )
    return _both("pareto", figure)


def _curves(study: Study, metric: str) -> dict[str, bytes]:
    column = study.metrics[metric]
    drawn = [(axis, analysis.curve(axis, study.metric(metric), column)) for axis in analysis.read_axes(study)]
    drawn = [(axis, found) for axis, found in drawn if np.isfinite([s[1] for s in found.samples]).any()]
    if not drawn:
        return {}
    title = analysis.axis_title(study.metric(metric))
    return _both("widths", figures.curves(drawn, title, [c for c in study.constraints if c.judged == metric]))


def pictures(study: Study) -> dict[str, bytes]:
    """Returns {file name: PNG} of every stored picture."""
    return {
        _file_name("picture", h[:12], scene, name) + ".png": png
        for h, scenes in study.pictures.items()
        for scene, shots in scenes.items()
        for name, png in shots.items()
    }
