# SPDX-License-Identifier: Apache-2.0
"""Makes the sections that hold a study's answer against something else: views that it never saw, words that follow from
ranges alone, what synthesis counts."""

from __future__ import annotations

import math
from html import escape
from typing import Any

from . import analysis, data
from .markup import Html, empty_section, note, point_link, section, table, variants
from .study import MeasuredCost, Study


def unseen(study: Study) -> str:
    """Returns the distribution of what each constraint judges over the views that no point was chosen by."""
    hashes = data.shown_hashes(study, study.validation)
    if not hashes:
        return empty_section(
            "unseen",
            "Unseen views",
            "No view was kept from the choice; validate or validate_views in the plan measures what is recommended on such.",
        )
    blocks = {}
    for h in hashes:
        panels = analysis.unseen_panels(study, h)
        views = list(zip(*(views for _, _, views in panels)))  # per view, what each constraint judges
        held = sum(all(judged.holds for judged in view) for view in views)
        verdict = "ok" if held == len(views) else "bad"
        plots = "".join(
            f'<div><h3>{escape(c.metric)}<span class="note">{escape(c.limits_text)}: {escape(analysis.held_text(of_it))}'
            f'</span></h3><div class="chart" data-plot="unseen" data-hash="{escape(h)}" data-part="{i}"></div></div>'
            for i, (_, c, of_it) in enumerate(panels)
        )
        rows = [
            (view[0].scene, "holds" if all(judged.holds for judged in view) else "fails", *(judged.value for judged in view))
            for view in views
        ]
        head = ["view", "all constraints", *(str(c) for _, c, _ in panels)]
        blocks[h] = (
            f'<p class="{verdict}">All constraints hold on {held} of {len(views)} views.</p><div class="grid">{plots}</div>'
            f"<details><summary>As a table</summary>{table(head, rows, scroll=True)}</details>"
        )
    return section(
        "unseen",
        "Unseen views",
        note(
            "The recommended point on views that no point was chosen by. A curve shows the share of these views with at "
            "most a value; the dashed line is the limit. This is a count, and promises nothing about other views."
        )
        + variants(study, hashes, blocks),
    )


def ranges(study: Study) -> str:
    """Returns, for each register that the study varies, the word that the range of its values asks for, beside the
    recommended word."""
    base = analysis.varied_registers(study)
    if not base or not study.recommended:
        return empty_section(
            "ranges",
            "Words from ranges alone",
            "This needs a register whose format the study varies, its values at the base, and a recommended point.",
        )

    def formats_of(point_hash: str) -> list[tuple[str, float]]:
        formats = {r.name: (r.short_format, r.word) for r in study.registers.get(point_hash, [])}
        return [formats.get(register.name, ("–", math.nan)) for register in base]

    columns: dict[str, list[tuple[str, float]]] = {
        "of the base": [(register.short_format, register.word) for register in base],
        "from the range": [register.from_range for register in base],
        **{data.point_name(study, found.hash): formats_of(found.hash) for found in study.recommended},
    }
    rows: list[list[Any]] = [
        [
            register.name,
            register.used_bits if register.count else math.nan,
            *(cell for column in columns.values() for cell in column[i]),
        ]
        for i, register in enumerate(base)
    ]
    totals = [("", sum(bits for _, bits in column)) for column in columns.values()]
    rows.append(["all of these", math.nan, *(cell for total in totals for cell in total)])
    return section(
        "ranges",
        "Words from ranges alone",
        note(
            "What a designer would try first: the integer bits that the values of the base used on the study's scenes, and "
            "the fraction bits of the base. Such words keep its precision, and another scene may need more. This "
            "configuration was not measured. A range cuts integer bits; a key that ends in .word cuts fraction bits. The "
            "ranges are observed: the database has no proved range of a register, since its bounds are those of errors."
        )
        + table(["register", "integer bits used", *(head for name in columns for head in (name, "bits"))], rows)
        + note("The last line counts each register once; cost.register_bits counts it as often as the pipeline has it."),
    )


def measured(study: Study) -> str:
    """Returns the estimated costs of the best points of a search beside what synthesis counted."""
    costs = study.measured_costs
    if not costs:
        return empty_section(
            "measured",
            "Estimated and measured costs",
            "Nothing was synthesised at the end of a search; a search for an estimated cost does so where [area] names its "
            "families.",
        )
    by_estimate = sorted(range(len(costs)), key=lambda i: costs[i].estimated)
    recommended = {found.hash for found in study.recommended}
    rows = [
        (
            i + 1,
            by_estimate.index(i) + 1,
            Html(point_link(study, c.hash).markup + (" recommended" if c.hash in recommended else "")),
            estimate_text(c.estimated, c.error),
            c.measured,
            "–" if math.isnan(c.measured) else f"{100 * (c.measured / c.estimated - 1):+.1f} %",
            _verdict(c),
        )
        for i, c in enumerate(costs)
    ]
    counted = [c for c in costs if not math.isnan(c.measured)]
    head = ["rank", "rank by estimate", "point", "estimated", "measured", "difference", ""]
    return section(
        "measured",
        "Estimated and measured costs",
        f"<p>{escape(study.cost_metric)}: measured within the ± at {sum(c.inside for c in counted)} of {len(counted)} points.</p>"
        + table(head, rows, scroll=len(rows) > 14)
        + note(
            "The search ended with synthesis of its best points, which are ranked by what was measured. A difference is in "
            "percent of the estimate. The certificate is that of the least estimate."
        ),
    )


def _verdict(cost: MeasuredCost) -> Any:
    if math.isnan(cost.measured):
        return Html(f'<span class="bad">failed</span>: {escape(cost.message)}')
    return "within the ±" if cost.inside else Html('<span class="bad">outside the ±</span>')


def estimate_text(value: float, error: float) -> str:
    """Returns a cost with its ±, in the words of `bitspan study`: "4512 ± 160"."""
    if error <= 0:
        return f"{value:.6g}"
    place = math.floor(math.log10(error)) - 1  # of the second digit of the ±
    digits = max(0, -place)
    return f"{value:.{digits}f} ± {round(error / 10.0**place) * 10.0**place:.{digits}f}"
