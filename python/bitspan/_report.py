# SPDX-License-Identifier: Apache-2.0
"""The report of a study. The package bitspan_report makes it, which works without this one."""

from __future__ import annotations

import os

import bitspan_report

from ._core import InputError


def report(
    database: str | os.PathLike[str],
    folder: str | os.PathLike[str],
    study: str | None = None,
    against: str | os.PathLike[str] | None = None,
    against_study: str | None = None,
) -> None:
    """Writes the report of a study into the folder: report.html, and its plots as SVG and PNG.

    `database` is the file that `bitspan study` wrote. `study` names the study where the database has several. `against` is
    a database with a study to compare with: `against_study`, or that of the same name, or its only one. Needs Matplotlib and
    Plotly: pip install "bitspan[report]".
    """
    try:
        bitspan_report.write(os.fspath(database), os.fspath(folder), study, None if against is None else os.fspath(against), against_study)
    except bitspan_report.ReportError as error:
        raise InputError(" ".join(str(error).split())) from None
