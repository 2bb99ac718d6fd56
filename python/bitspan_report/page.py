# SPDX-License-Identifier: Apache-2.0
"""Makes the report as one HTML file that needs nothing else. Text and tables are made here; page.js draws the plots."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import pathlib
from collections.abc import Sequence
from html import escape
from typing import Any

from . import analysis, answer, data
from .markup import Html, empty_section, note, or_dash, point_link, section, table, variants
from .study import Area, Study, listed_scenes

REFUSED_ROWS = 1000  # of the table; the plot and its panel know all

WORST_SCENE = (
    "“worst scene” is what a constraint judges: the scene that is nearest to the limit, or farthest beyond it. The same "
    "metric without these words is that of all scenes together."
)

_HERE = pathlib.Path(__file__).resolve().parent

PICTURE_TITLES = {
    "ideal": "ideal",
    "model": "this configuration",
    "difference": "difference, brightened",
    "u_error": "texture error",
    "depth_error": "depth error",
    "dominant": "dominant cause of the error",
}


def _scene_names(study: Study) -> str:
    """Returns the names of the scenes with the start of their content hashes."""
    stored = next((p.scenes for p in study.points if p.scenes), "")
    scenes = listed_scenes(stored)
    if scenes is None:
        return stored
    return ", ".join(
        f"{s['name']} ({str(s.get('hash', ''))[:8]})" if isinstance(s, dict) and "name" in s else str(s) for s in scenes
    )


def studied(study: Study, axes: list[analysis.Axis]) -> str:
    """Returns what was varied, on what, and how many points came of it."""
    refused = sum(p.refused for p in study.points)
    held = sum(p.holds is True for p in study.points)
    seconds = sum(p.seconds for p in study.points if not math.isnan(p.seconds))
    base = study.points[study.base] if study.base is not None else None
    idle = [
        f"{axis.label} does not move {study.cost_metric}: {count} sets of points differ in it alone, and each has one cost"
        for axis, count in analysis.idle_axes(study, axes)
    ]
    facts: list[tuple[str, str]] = [
        ("kind", escape(study.kind)),
        (
            "base",
            f"configuration <code>{escape(base.config_hash[:16])}</code>, {point_link(study, base.hash).markup}"
            if base
            else "not measured",
        ),
        ("scenes", escape(_scene_names(study)) or "–"),
        ("varied", "<br>".join(escape(varied.title) for varied in study.axes) or "nothing"),
        *([("idle axes", "<br>".join(map(escape, idle)))] if idle else []),
        ("constraints", "<br>".join(escape(str(c)) for c in study.constraints) or "none"),
        (
            "points",
            f"{len(study.points)} measured or tried, {refused} refused"
            + (f", {held} hold all constraints" if study.constraints else ""),
        ),
        ("computed in", f"{seconds:.3g} s of one core's time" if seconds else "–"),
        ("database", f"<code>{escape(study.database)}</code>, written by bitspan {escape(study.version) or '?'}"),
    ]
    listed = "".join(f"<dt>{escape(k)}</dt><dd>{v}</dd>" for k, v in facts)
    return section(
        "studied",
        "What was studied",
        f"<dl class=facts>{listed}</dl><details><summary>The plan</summary><pre>{escape(study.plan)}</pre></details>",
    )


def recommended(study: Study) -> str:
    """Returns one card per recommended configuration: why, verified how, what it sets, its TOML."""
    if not study.recommended:
        return empty_section("recommended", "Recommended configurations", "This study recommends none.")
    cards, base_values = [], study.base_settings
    for found in study.recommended:
        index = study.index_of(found.hash)
        verified = (
            f'<span class="{"ok" if found.verified.startswith("equal") else "bad"}">{escape(found.verified)}</span>'
            if found.verified
            else '<span class="bad">not verified</span>'
        )
        parts = [
            f"<h3>{point_link(study, found.hash).markup} {escape(found.reason)}</h3><p>Verification: {verified}</p>"
        ]
        if index is None:
            cards.append(f'<div class="card">{"".join(parts)}{note("Its point is not in the database.")}</div>')
            continue
        names = [
            *analysis.cost_metrics(study),
            *(c.judged for c in study.constraints),
            *analysis.error_metrics(study)[:6],
        ]
        values = [
            (
                n,
                study.metrics[n][index],
                study.unit_of(n),
                study.metrics[n][study.base] if study.base is not None else math.nan,
            )
            for n in dict.fromkeys(names)
            if n in study.metrics
        ]
        settings = [(key, value, or_dash(base_values.get(key))) for key, value in study.points[index].settings.items()]
        tables = [table(["metric", "value", "unit", "of the base"], values)]
        if settings:
            tables.insert(0, table(["setting", "value", "of the base"], settings))
        if found.findings:
            parts.append("<ul>" + "".join(f"<li>{escape(line)}</li>" for line in found.findings) + "</ul>")
        parts.append('<div class="beside">' + "".join(f"<div>{t}</div>" for t in tables) + "</div>")
        parts.append(_scenes_table(study, found.hash))
        parts.append(
            f'<p style="margin-top:10px"><button data-copy="toml" data-index="{index}">Copy TOML</button> '
            f'<button data-copy="replay" data-index="{index}">Copy replay command</button></p>'
            f"<details><summary>TOML</summary><pre>{escape(study.points[index].config)}</pre></details>"
        )
        cards.append(f'<div class="card">{"".join(parts)}</div>')
    return section("recommended", "Recommended configurations", "".join(cards))


def _scenes_table(study: Study, point: str) -> str:
    """Returns the metrics that the plan names and those of its constraints, one row per scene; none for one scene."""
    scenes = study.scenes.get(point, {})
    names = dict.fromkeys([*(c.metric for c in study.constraints), *study.chosen_metrics])
    shown = [n for n in names if any(n in metrics for metrics in scenes.values())]
    if len(scenes) < 2 or not shown:
        return ""
    rows = [(scene, *(metrics.get(n, math.nan) for n in shown)) for scene, metrics in scenes.items()]
    return f"<details><summary>Each scene alone</summary>{table(['scene', *shown], rows)}</details>"


def errors(study: Study) -> str:
    """Returns the error of every field of every stage, for the configurations that matter."""
    hashes = data.shown_hashes(study, study.errors)
    if not hashes:
        return empty_section("errors", "Errors by stage", "Neither the base nor a recommended point was measured.")
    labels = dict.fromkeys(m.label for m in study.known.values() if m.label)
    head = ["stage", "quantity", "unit", "values", *labels]
    names = {(m.field, m.label): m.name for m in study.known.values()}
    blocks = {}
    for h in hashes:
        index = study.index_of(h)

        def value(field: str, label: str) -> float:
            column = study.metrics.get(names.get((field, label), ""))
            return math.nan if column is None or index is None else column[index]

        rows = [
            (e.stage, e.quantity, e.unit, e.count, *(value(e.name, label) for label in labels)) for e in study.errors[h]
        ]
        blocks[h] = table(head, rows, scroll=len(rows) > 14)
    return section(
        "errors",
        "Errors by stage",
        note("Against the unquantised truth, over all scenes.") + variants(study, hashes, blocks),
    )


def pareto(study: Study) -> str:
    """Returns the plot of error against cost, and the place where a clicked configuration is shown."""
    if not any(not p.refused for p in study.points) or not study.metrics:
        return empty_section("pareto", "Error against cost", "No point was measured.")
    return section(
        "pareto",
        "Error against cost",
        (
            '<div class="controls"><label>error <select id="pareto-y"></select></label>'
            '<label>cost <select id="pareto-x"></select></label>'
            '<button id="pareto-previous" title="previous point of the front">◀ front</button>'
            '<button id="pareto-next" title="next point of the front">front ▶</button></div>'
            '<div class="pareto"><div><div id="pareto-plot" class="chart"></div>'
            '<p class="note">The line is the Pareto front: no point has less of both. A dashed line is a constraint. '
            f"{WORST_SCENE + ' ' if study.worst_scenes else ''}Click a point to see its configuration.</p></div>"
            '<div id="detail" class="detail" aria-live="polite"><p class="note">Click a point of the plot: its settings, '
            "its metrics, its TOML and the command that runs it again appear here.</p></div></div>"
        ),
    )


def curves(study: Study, axes: Sequence[analysis.Axis]) -> str:
    """Returns the place of the plots of error against each varied key."""
    if not axes:
        return empty_section("widths", "Error against each key", "No key took two values among the measured points.")
    return section(
        "widths",
        "Error against each key",
        (
            '<div class="controls"><label>error <select id="widths-y"></select></label></div>'
            f'<div id="widths-plots" class="grid"></div>{note(analysis.KNEE_DEFINITION)}'
            + note(
                "“one at a time”: all other keys as in the base. “best of all”: the best point with that value, whatever "
                "its other keys."
            )
        ),
    )


def registers(study: Study) -> str:
    """Returns histograms and a table of what each register held."""
    hashes = data.shown_hashes(study, study.registers)
    if not hashes:
        return empty_section("registers", "What the registers held", "No register was observed.")
    head = ["register", "format", "min", "max", "used bits", "head-room", "wraps", "saturations", "values", "zeros"]
    blocks = {}
    for h in hashes:
        rows = [
            (r.name, r.format, r.min, r.max, r.used_bits, r.headroom, r.wraps, r.saturations, r.count, r.zeros)
            for r in study.registers[h]
        ]
        blocks[h] = (
            f'<div class="chart" data-plot="registers" data-hash="{escape(h)}"></div>'
            f"<details><summary>As a table</summary>{table(head, rows, scroll=True)}</details>"
        )
    return section(
        "registers",
        "What the registers held",
        (
            '<p class="note">Values by magnitude, one octave per bar, heights by the logarithm of their count; behind them '
            "what the format can hold, from its last place to its range; the hatched part was never used. Used bits and "
            "head-room count integer bits.</p>" + variants(study, hashes, blocks)
        ),
    )


def budget(study: Study) -> str:
    """Returns the error budget as stacked bars and as a table."""
    hashes = data.shown_hashes(study, study.budget)
    if not hashes:
        return empty_section(
            "budget",
            "Error budget",
            "This study has no error budget; [report] budget = true in its plan adds that of what is recommended.",
        )
    blocks = {}
    for h in hashes:
        rows = [(b.metric, b.quantisation, b.base, b.without, b.alone) for b in study.budget[h]]
        head = ["metric", "quantisation", "whole error", "without it", "it alone"]
        blocks[h] = (
            f'<div class="chart" data-plot="budget" data-hash="{escape(h)}"></div>'
            f"<details><summary>As a table</summary>{table(head, rows, scroll=True)}</details>"
        )
    return section(
        "budget",
        "Error budget",
        (
            '<p class="note">Each quantisation alone, all others exact, as a part of the whole error; of an RMS its '
            "square, since squares of independent errors add. What even the smallest leaves alone, such as the rounding "
            "of the output, is common to all. A bar that ends short of 100 % or beyond it says that the causes do not "
            "simply add.</p>" + variants(study, hashes, blocks)
        ),
    )


def bounds(study: Study) -> str:
    """Returns proved bounds beside what was observed."""
    hashes = data.shown_hashes(study, study.bounds)
    if not hashes:
        return empty_section(
            "bounds",
            "Proved bounds",
            "This study has no proved bounds; [report] bounds = true in its plan adds those of what is recommended.",
        )
    blocks = {}
    for h in hashes:
        rows = [
            (
                b.place,
                b.unit,
                b.bound,
                b.observed,
                Html(f'<span class="bad">{b.reached}: observed above the bound</span>') if b.broken else b.reached,
            )
            for b in study.bounds[h]
        ]
        blocks[h] = f'<div class="chart" data-plot="bounds" data-hash="{escape(h)}"></div>' + table(
            ["place", "unit", "proved bound", "largest observed", "observed / bound"], rows, scroll=len(rows) > 14
        )
    return section(
        "bounds",
        "Proved bounds",
        (
            '<p class="note">An error that no input in the configured ranges exceeds, beside the largest observed on the '
            "scenes. Up to 100 % of it, the bound holds.</p>" + variants(study, hashes, blocks)
        ),
    )


def _said_once(outcome: str) -> str:
    """Returns the outcome's text, without its kind in front where that is the same text."""
    kind, _, text = outcome.partition(": ")
    return text if kind == text else outcome


def search(study: Study) -> str:
    """Returns the progress of the search, and the certificate of what it found."""
    if not study.steps and not study.certificate:
        return empty_section("search", "Search", "This study did not search.")
    parts = []
    if study.steps:
        parts.append(
            '<div id="search-plot" class="chart"></div>'
            f'<p class="note">{len(study.steps)} evaluations; click one to see its configuration.</p>'
        )
    if study.combinations:
        parts.append("<h3>Combinations</h3>")
        parts.append(note("The widths were searched for each combination of categories; the cheapest is the answer."))
        parts.append(
            table(
                ["combination", study.cost_metric, "evaluations", "stopped by", "minimal", "what fails", "point"],
                [
                    (
                        c.name,
                        c.cost,
                        c.evaluations,
                        c.stopped_by,
                        ("yes" if c.minimal else "no") if c.hash else "–",
                        c.failing,
                        point_link(study, c.hash),
                    )
                    for c in study.combinations
                ],
                scroll=len(study.combinations) > 14,
            )
        )
    parts.append("<h3>Certificate</h3>")
    if study.certificate:
        of_each = ["combination"] if study.combinations else []
        parts.append(
            note(
                "Each way to lower the found point by one step down, or by a pair of one step up and two down, and why "
                "it is not taken."
            )
        )
        parts.append(
            table(
                [*of_each, "key", "from", "to", "outcome", "point"],
                [
                    (
                        *([c.combination] if of_each else []),
                        c.key,
                        c.from_value,
                        c.to_value,
                        _said_once(c.failed),
                        point_link(study, c.hash),
                    )
                    for c in study.certificate
                ],
                scroll=len(study.certificate) > 14,
            )
        )
    else:
        parts.append(note("No point was certified."))
    return section("search", "Search", "".join(parts))


def pictures(study: Study) -> str:
    """Returns the ideal, chosen and difference pictures side by side, and the heat maps, zoomed together."""
    hashes = data.shown_hashes(study, study.pictures)
    if not hashes:
        return empty_section("pictures", "Pictures", "No picture was kept.")
    blocks = {}
    for h in hashes:
        scenes = study.pictures[h]
        options = "".join(f"<option>{escape(scene)}</option>" for scene in scenes)
        viewers = []
        for number, (scene, shots) in enumerate(scenes.items()):
            figures = "".join(
                f'<figure><figcaption><span>{escape(PICTURE_TITLES.get(name, name))}</span><span class="mono"></span>'
                f'</figcaption><canvas data-name="{escape(name)}" data-png="{base64.b64encode(png).decode()}"></canvas></figure>'
                for name, png in _in_order(shots)
            )
            viewers.append(
                f'<div class="viewer" data-scene="{escape(scene)}"{" hidden" if number else ""}>'
                f'<div class="views">{figures}</div>{_legend(study, h, scene)}</div>'
            )
        blocks[h] = (
            f'<div class="controls"><label>scene <select class="scenes">{options}</select></label>'
            '<button class="zoom-in">zoom in</button><button class="zoom-out">zoom out</button>'
            '<button class="zoom-reset">whole picture</button>'
            f"<span>wheel: zoom, drag: move, all together</span></div>{''.join(viewers)}"
        )
    return section("pictures", "Pictures", variants(study, hashes, blocks))


def _legend(study: Study, point_hash: str, scene: str) -> str:
    """Returns what the colours of the map of dominant causes mean, the most frequent first. Grey ones count as one."""
    causes = study.causes.get(point_hash, {}).get(scene, [])
    total = sum(cause.pixels for cause in causes)
    if total == 0:
        return ""
    pixels: dict[str, list[Any]] = {}  # names and count, by colour
    for cause in causes:
        entry = pixels.setdefault(cause.colour, [[], 0])
        entry[0].append(cause.name)
        entry[1] += cause.pixels
    items = "".join(
        f'<li><i style="background:{colour}"></i>{escape(", ".join(names))} {100 * count / total:.3g} %</li>'
        for colour, (names, count) in pixels.items()
    )
    heading = '<p class="note" style="margin-top:8px">Dominant cause, of the pixels that err:</p>'
    return f'{heading}<ul class="legend">{items}</ul>'


def _in_order(shots: dict[str, bytes]) -> list[tuple[str, bytes]]:
    """Returns the pictures of a scene in the order in which people compare them, with unknown names last."""
    order = list(PICTURE_TITLES)
    return sorted(shots.items(), key=lambda shot: order.index(shot[0]) if shot[0] in order else len(order))


def areas(study: Study) -> str:
    """Returns what synthesis and placement said."""
    rows = [
        (
            point_link(study, p.hash),
            a.name,
            "placed" if a.placed else "synthesised",
            _area_status(a),
            *(a.values.get(c, math.nan) for c in ("luts", "ffs", "multipliers", "memory_bits", "fmax_mhz")),
        )
        for p in study.points
        for a in study.areas.get(p.config_hash, [])
    ]
    if not rows:
        return empty_section(
            "areas",
            "Area and clock",
            "Nothing was synthesised; [area] in the plan synthesises what is recommended.",
        )
    tools = sorted({tool for found in study.areas.values() for a in found if a.tools for tool in a.tools.split("; ")})
    head = ["point", "family", "to", "result", "LUTs", "flip-flops", "multipliers", "memory bits", "Fmax [MHz]"]
    return section(
        "areas",
        "Area and clock",
        table(head, rows, scroll=len(rows) > 14) + (note("By " + "; ".join(tools)) if tools else ""),
    )


def _area_status(area: Area) -> Any:
    if area.status == "ok":
        return "fits" if area.placed else "ok"
    words = area.status.replace("_", " ")
    return Html(f'<span class="bad">{escape(words)}</span>{": " + escape(area.message) if area.message else ""}')


def refused(study: Study) -> str:
    """Returns the configurations that could not be measured, each with its reason."""
    rows = [
        (point_link(study, p.hash), ", ".join(f"{k} = {v}" for k, v in p.settings.items()) or "–", p.message)
        for p in study.points
        if p.refused
    ]
    if not rows:
        return empty_section("refused", "Refused points", "None: every point was measured.")
    more = len(rows) - REFUSED_ROWS
    query = "SELECT hash, message FROM points WHERE status = 'refused'"
    return section(
        "refused",
        "Refused points",
        table(["point", "settings", "reason"], rows[:REFUSED_ROWS], scroll=len(rows) > 12)
        + (note(f'{more} more are not listed here: sqlite3 {study.database} "{query}"') if more > 0 else ""),
    )


def embedded_json(value: Any) -> str:
    """Returns JSON that may stand inside a script element."""
    text = json.dumps(value, separators=(",", ":"), allow_nan=False, ensure_ascii=True)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _script_hash(script: str) -> str:
    return "'sha256-" + base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() + "'"


_NAVIGATION = (
    ("studied", "Study"),
    ("recommended", "Recommended"),
    ("unseen", "Unseen views"),
    ("ranges", "Words from ranges"),
    ("pareto", "Error against cost"),
    ("widths", "Widths"),
    ("errors", "Errors"),
    ("registers", "Registers"),
    ("budget", "Budget"),
    ("bounds", "Bounds"),
    ("search", "Search"),
    ("measured", "Measured costs"),
    ("areas", "Area"),
    ("pictures", "Pictures"),
    ("refused", "Refused"),
)


def page(study: Study, plotly: str, compared: str = "") -> str:
    """Returns the whole report. `plotly` is the library's source, `compared` the section on another study, if any. The policy in the head lets no other script run."""
    axes = analysis.read_axes(study)
    sections = (
        studied(study, axes),
        recommended(study),
        answer.unseen(study),
        answer.ranges(study),
        pareto(study),
        curves(study, axes),
        errors(study),
        registers(study),
        budget(study),
        bounds(study),
        search(study),
        answer.measured(study),
        areas(study),
        pictures(study),
        refused(study),
    )
    links = [*_NAVIGATION, *([("compared", "Compared")] if compared else [])]
    navigation = " ".join(f'<a href="#{i}">{escape(text)}</a>' for i, text in links)
    script = "\n".join((_HERE / name).read_text("utf-8") for name in ("page.js", "plots.js", "cloud.js", "viewer.js"))
    plotly, script = plotly.replace("\r", ""), f"\n{script}"
    policy = (
        f"default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; "
        f"script-src {_script_hash(plotly)} {_script_hash(script)}"
    )
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(study.name)}: bitspan study</title>
<link rel="icon" href="data:,">
<style>
{(_HERE / "page.css").read_text("utf-8")}</style>
</head>
<body>
<header><h1>{escape(study.name)}<small>bit-width study, {len(study.points)} points</small></h1></header>
<nav>{navigation}</nav>
<main>{''.join(sections)}{compared}</main>
<footer>Drawn with plotly.js (MIT licence), which this file holds; it loads nothing. The same plots stand beside it as
SVG and PNG.</footer>
<script type="application/json" id="data">{embedded_json(data.page_data(study, axes))}</script>
<script>{plotly}</script>
<script>{script}</script>
</body>
</html>
"""
