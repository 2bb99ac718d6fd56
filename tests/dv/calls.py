# SPDX-License-Identifier: Apache-2.0
"""Measures calls per second of DPI-C and of VPI, by the benches that the tests have built:

    BITSPAN_BUILD=build/release/tests/dv python3 tests/dv/calls.py
"""

import os
import pathlib
import subprocess
import time


def seconds(folder, command, *arguments):
    start = time.perf_counter()
    subprocess.run([*command, *arguments], cwd=folder, stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - start


build = pathlib.Path(os.environ["BITSPAN_BUILD"]).resolve()
for name, command, records in (("dpi", ["rows/Vrows_tb"], 300000), ("vpi", ["vvp", "-n", "-M.", "rows_tb.vvp"], 100000)):
    took = min(seconds(build / name, command, f"+records={records}") - seconds(build / name, command, "+records=0") for _ in range(3))
    print(f"{name}: {2 * records / took:.0f} calls per second")
