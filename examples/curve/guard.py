#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Show what guard bits of forward_difference buy, for 4 to 64 steps per curve.

    bitspan study config/studies/curve.toml --csv-scenes curve.csv
    examples/curve/guard.py curve.csv curve-guard.png

prints the tables of docs/studies/curve.md and draws its picture.
"""

import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot  # noqa: E402 (the backend comes first)

GRID = 18  # fraction bits of the control points
MISSING = (0, 1, 2, 3, 6)  # guard bits below 3 k


def read(path: str) -> dict[str, dict[int, dict[int, dict[str, str]]]]:
    """The lines of the CSV file by rounding, k and guard bits."""
    out: dict[str, dict[int, dict[int, dict[str, str]]]] = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            k = int(row["scene"].rsplit("=", 1)[1])
            out.setdefault(row["rounding"], {}).setdefault(k, {})[int(row["fraction"]) - GRID] = row
    return out


def table(by_k: dict[int, dict[int, dict[str, str]]], metric: str, text: str) -> None:
    print(f"| {text} | " + " | ".join(f"3 k - {n}" if n else "3 k" for n in MISSING) + " | 0 |\n|---|" + "---:|" * (len(MISSING) + 1))
    for k, points in by_k.items():
        cells = [f"{float(points[3 * k - n][metric]):.3g}" for n in MISSING] + [f"{float(points[0][metric]):.3g}"]
        print(f"| {1 << k} | " + " | ".join(cells) + " |")
    print()


def main() -> int:
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    roundings = read(sys.argv[1])
    for rounding, by_k in roundings.items():
        print(rounding)
        table(by_k, "curve.error_max", "largest error, by steps")
        table(by_k, "curve.error_bound", "its bound, by steps")
        table(by_k, "curve.missed_ends", "curves beside their end, by steps")
    by_k = roundings["SC_RND"]
    figure, (error, ends) = matplotlib.pyplot.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
    for k, points in by_k.items():
        guard = sorted(points)
        errors = [float(points[n]["curve.error_max"]) for n in guard]
        shown = [n for n, e in zip(guard, errors) if e > 0]
        error.plot(shown, [e for e in errors if e > 0], marker="o", label=f"{1 << k} steps")
        error.axvline(3 * k, color=error.lines[-1].get_color(), linewidth=0.8, linestyle="--")
        share = [100 * float(points[n]["curve.missed_ends"]) / float(points[n]["curve.curves"]) for n in guard]
        ends.plot(guard, share, marker="o", label=f"{1 << k} steps")
    error.set(xlabel="guard bits; dashed: 3 k, where no point is off", ylabel="largest error, steps of the grid", yscale="log")
    ends.set(xlabel="guard bits", ylabel="curves that miss their end, %")
    for axis in (error, ends):
        axis.set_xticks(range(0, 20, 3))
    ends.legend()
    figure.savefig(sys.argv[2], dpi=100)
    return 0


if __name__ == "__main__":
    sys.exit(main())
