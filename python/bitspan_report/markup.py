# SPDX-License-Identifier: Apache-2.0
"""Makes the HTML that the page's sections share: sections, tables, links to points, menus of configurations."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

from . import data
from .study import Study


def text_of(value: Any) -> str:
    """Returns a value for people, not yet escaped: at least four significant digits, and names of what is no number."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        if math.isnan(value):
            return "–"
        if math.isinf(value):
            return "∞" if value > 0 else "−∞"
        whole = abs(value) < 1e7 and (value.is_integer() or abs(value) >= 1e4)
        return str(round(value)) if whole else f"{value:.4g}"
    return str(value)


def table(head: Sequence[str], rows: Iterable[Sequence[Any]], scroll: bool = False) -> str:
    """Returns an HTML table. Numbers are right-aligned, and all cells are escaped but those that are Html."""
    body, right = [], [True] * len(head)
    for row in rows:
        cells = []
        for i, cell in enumerate(row):
            numeric = isinstance(cell, (int, float)) and not isinstance(cell, bool)
            right[i] = right[i] and numeric
            kind = "n" if numeric else "long"
            content = cell.markup if isinstance(cell, Html) else escape(text_of(cell))
            cells.append(f'<td class="{kind}">{content}</td>')
        body.append("<tr>" + "".join(cells) + "</tr>")
    header = "".join(f"<th{' class=n' if r and body else ''}>{escape(h)}</th>" for h, r in zip(head, right))
    whole = f"<table><thead><tr>{header}</tr></thead><tbody>{''.join(body)}</tbody></table>"
    return f'<div class="scroll" tabindex="0">{whole}</div>' if scroll else whole


class Html:
    """Markup that is already safe."""

    def __init__(self, markup: str) -> None:
        self.markup = markup


def point_link(study: Study, point_hash: str) -> Html:
    """Returns a button that shows the point beside the Pareto plot, and plain text for points that the page lacks."""
    short = escape(point_hash[:12])
    index = study.index_of(point_hash)
    if index is None:
        return Html(f"<code>{short}</code>")
    return Html(f'<button class="plain-link mono" data-point="{index}">{short}</button>')


def note(text: str) -> str:
    return f'<p class="note">{escape(text)}</p>'


def section(identity: str, title: str, content: str) -> str:
    return f'<section id="{identity}"><h2>{escape(title)}</h2>{content}</section>'


def empty_section(identity: str, title: str, why: str) -> str:
    """Returns a section that has nothing to show, in one line."""
    return f'<section id="{identity}" class="empty"><h2>{escape(title)}</h2>{note(why)}</section>'


def variants(study: Study, hashes: Sequence[str], contents: dict[str, str]) -> str:
    """Returns one block per configuration of {hash: markup}, and a menu that shows one of them."""
    blocks = "".join(
        f'<div class="variant" data-hash="{escape(h)}"{"" if h == hashes[0] else " hidden"}>{contents[h]}</div>'
        for h in hashes
    )
    options = "".join(f'<option value="{escape(h)}">{escape(data.point_name(study, h))}</option>' for h in hashes)
    return (
        f'<div class="controls"><label>Configuration <select class="variants">{options}</select></label></div>{blocks}'
    )


def or_dash(value: Any) -> Any:
    """Returns the value of a cell, a dash for none."""
    return "–" if value is None else value
