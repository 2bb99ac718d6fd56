# SPDX-License-Identifier: Apache-2.0
"""python3 -m bitspan_report DATABASE OUT_DIR [--study NAME] [--against DATABASE [--against-study NAME]]"""

from __future__ import annotations

import argparse
import sys

from . import ReportError, write


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="bitspan_report",
        description="Writes OUT_DIR/report.html, one file that needs nothing else, and its plots "
        "as SVG and PNG beside it, from the database that `bitspan study` writes.",
        epilog="example: python3 -m bitspan_report dividers.db out/dividers",
        allow_abbrev=False,
    )
    parser.add_argument("database", metavar="DATABASE", help="the study's SQLite file")
    parser.add_argument("folder", metavar="OUT_DIR", help="folder of the report; made where it is missing")
    parser.add_argument("--study", metavar="NAME", help="which study, where the database holds several")
    parser.add_argument("--against", metavar="DATABASE", help="compare with the study of this SQLite file")
    parser.add_argument(
        "--against-study", metavar="NAME", help="which study of it (default: that of the same name, or its only one)"
    )
    arguments = parser.parse_args()
    if arguments.against_study is not None and arguments.against is None:
        parser.error("--against-study: goes with --against")
    return arguments


def main() -> int:
    """Returns 0 where the report is written, and 2 for bad input or nowhere to write, with one line that says what."""
    arguments = _arguments()
    try:
        write(arguments.database, arguments.folder, arguments.study, arguments.against, arguments.against_study)
    except ReportError as error:
        print(f"bitspan_report: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
