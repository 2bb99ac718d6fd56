# SPDX-License-Identifier: Apache-2.0
"""Tables as a notebook shows them."""

from __future__ import annotations

import html
from typing import Any, Iterable, Sequence


def text_of(value: Any) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def table(head: Sequence[str], rows: Iterable[Sequence[Any]], caption: str = "") -> str:
    def line(tag: str, cells: Sequence[Any]) -> str:
        return "<tr>" + "".join(f"<{tag}>{html.escape(text_of(cell))}</{tag}>" for cell in cells) + "</tr>"

    top = f"<caption>{html.escape(caption)}</caption>" if caption else ""
    return f"<table>{top}<thead>{line('th', head)}</thead><tbody>" + "".join(line("td", row) for row in rows) + "</tbody></table>"
