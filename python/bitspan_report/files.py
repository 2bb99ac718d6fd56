# SPDX-License-Identifier: Apache-2.0
"""Writes files that appear complete, or not at all."""

from __future__ import annotations

import contextlib
import os
import pathlib

from . import ReportError


def write_all(folder: str, files: dict[str, bytes]) -> None:
    """Writes {name: bytes} into the folder, which is made where it is missing. Throws ReportError.

    All files go to temporary names first. They are renamed, in the order given, when the last one is on disk. A failure
    for lack of room therefore leaves the folder's files as they were.
    """
    target = pathlib.Path(folder)
    temporary: dict[pathlib.Path, pathlib.Path] = {}
    current = target
    try:
        target.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            current = target / name
            partial = target / f".{name}.{os.getpid()}.partial"
            temporary[partial] = current
            with open(partial, "wb") as stream:
                stream.write(content)
                stream.flush()
                os.fsync(stream.fileno())
        for partial, current in temporary.items():
            partial.replace(current)
    except OSError as error:
        raise ReportError(f"{current}: cannot write: {error.strerror}") from None
    finally:
        for partial in temporary:
            with contextlib.suppress(OSError):
                partial.unlink(missing_ok=True)
