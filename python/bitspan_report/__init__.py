# SPDX-License-Identifier: Apache-2.0
"""The report of a study: one HTML page, and its plots as SVG and PNG, from the database `bitspan study` writes."""


class ReportError(Exception):
    """What a person can mend: one line that names the file and what is wrong with it."""
