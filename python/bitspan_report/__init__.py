# SPDX-License-Identifier: Apache-2.0
"""Makes the report of a study from the database `bitspan study` writes: one HTML page, and its plots as SVG and PNG."""


class ReportError(Exception):
    """An error that a user can mend. Its one line names the file and what is wrong with it."""
