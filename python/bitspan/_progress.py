# SPDX-License-Identifier: Apache-2.0
"""How far a sweep or a search is: in a notebook, or on a terminal."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any


def _notebook() -> bool:
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and type(shell).__name__ == "ZMQInteractiveShell"


class Progress:
    """Shows "12 of 100 points". `shown` None: in a notebook and on a terminal only."""

    def __init__(self, shown: bool | None, interval: float = 0.2):
        self._notebook = _notebook()
        self._shown = self._notebook or sys.stderr.isatty() if shown is None else shown
        self._interval = interval
        self._last = ""
        self._next = time.monotonic() + interval
        self._display: Any = None

    def tell(self, text: str) -> None:
        self._last = text
        if self._shown and time.monotonic() >= self._next:
            self._next = time.monotonic() + self._interval
            self._show(text)

    def _show(self, text: str) -> None:
        if not self._notebook:
            sys.stderr.write(f"\r{text}\x1b[K")
            sys.stderr.flush()
        elif self._display is None:
            from IPython.display import display

            self._display = display({"text/plain": text}, raw=True, display_id=True)
        else:
            self._display.update({"text/plain": text}, raw=True)

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._shown:
            self._show(self._last if self._notebook else "")
