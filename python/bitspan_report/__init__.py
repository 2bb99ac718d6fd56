# SPDX-License-Identifier: Apache-2.0
"""Makes the report of a study from the database `bitspan study` writes: one HTML page, and its plots as SVG and PNG.

It stands beside the package `bitspan` and does not need it.
"""

from __future__ import annotations

import importlib.util
import sys


class ReportError(Exception):
    """An error that a user can mend. Its one line names the file and what is wrong with it."""


def write(
    database: str, folder: str, study: str | None = None, against: str | None = None, against_study: str | None = None
) -> None:
    """Writes the report of a study into the folder, report.html last; `study` names it where the database has several.

    `against` is a database with a study to compare with: `against_study`, or else the one of the same name, or else
    the only one.

    Throws ReportError, also where a library is missing.
    """
    missing = [name for name in ("matplotlib", "numpy", "plotly") if importlib.util.find_spec(name) is None]
    if missing:
        packages = ", ".join(f"python3-{name}" for name in missing)
        raise ReportError(
            f"{sys.executable} has no module {', '.join(missing)}; Debian's python3 has it by {packages}, "
            f"another by pip install {' '.join(missing)}"
        )
    from .database import load_other, load_study  # imported here, because these modules need the libraries

    found = load_study(database, study)
    other = load_other(against, against_study, found.name) if against is not None else None
    from .report import write_report  # imported after bad input is refused: it takes a second to load

    write_report(found, folder, other)
