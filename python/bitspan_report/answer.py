# SPDX-License-Identifier: Apache-2.0
"""Makes the sections on how far a study's answer holds: on views that it never saw."""

from __future__ import annotations

from html import escape

from . import analysis, data
from .markup import empty_section, note, section, table, variants
from .study import Study


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
