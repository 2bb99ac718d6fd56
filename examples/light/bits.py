#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Show how many bits a light per pixel needs, for three highlights.

    bitspan study config/studies/light.toml --csv-scenes light.csv
    examples/light/bits.py light.csv light-bits.png

prints the tables of docs/studies/light.md and draws its picture.
"""

import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot  # noqa: E402 (the backend comes first)

CODES = 255  # of full brightness
HALF = 0.5  # the constraint, in codes
AXES = {
    "vector": "fraction bits of the vectors",
    "cosine": "fraction bits of cosine and highlight",
    "table": "index bits of the table",
}


def read(path: str) -> dict[int, dict[tuple[int, ...], dict[str, str]]]:
    """The lines of the CSV file by the highlight's exponent, and by the values of the axes."""
    out: dict[int, dict[tuple[int, ...], dict[str, str]]] = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            exponent = int(row["scene"].rsplit(",", 1)[1])
            out.setdefault(exponent, {})[tuple(int(row[axis]) for axis in AXES)] = row
    return out


def error(row: dict[str, str]) -> float:
    return CODES * float(row["light.value.p999"])


def along(points: dict[tuple[int, ...], dict[str, str]], place: int) -> dict[int, float]:
    """The errors along one axis, where the others have most bits."""
    most = [max(values) for values in zip(*points)]
    return {p[place]: error(row) for p, row in sorted(points.items()) if all(p[i] == most[i] for i in range(len(p)) if i != place)}


def cost(row: dict[str, str]) -> float:
    return float(row["cost.product_bits"]) + float(row["cost.table_bits"])


def main() -> int:
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    highlights = read(sys.argv[1])
    figure, axes = matplotlib.pyplot.subplots(1, len(AXES), figsize=(9, 3.4), sharey=True, layout="constrained")
    for place, (axis, text) in enumerate(AXES.items()):
        lines = {exponent: along(points, place) for exponent, points in highlights.items()}
        bits = list(next(iter(lines.values())))
        print(f"| {text} | " + " | ".join(map(str, bits)) + " |\n|---|" + "---:|" * len(bits))
        for exponent, line in lines.items():
            print(f"| exponent {exponent} | " + " | ".join(f"{line[n]:.3g}" for n in bits) + " |")
            axes[place].plot(bits, [line[n] for n in bits], marker="o", label=str(exponent))
        print()
        axes[place].axhline(HALF, color="grey", linewidth=0.8, linestyle="--")
        axes[place].set(xlabel=text, xticks=bits, yscale="log")
    axes[0].set_ylabel("error of brightness, codes (99.9 %)")
    axes[-1].legend(title="exponent")
    figure.savefig(sys.argv[2], dpi=100)
    print("| exponent | " + " | ".join(AXES) + " | product bits | table bits | error |\n|---|" + "---:|" * (len(AXES) + 3))
    for exponent, points in highlights.items():
        held = [(cost(row), p) for p, row in points.items() if error(row) <= HALF]
        if not held:
            continue
        best = min(held)[1]
        row = points[best]
        cells = [*best, row["cost.product_bits"], row["cost.table_bits"], f"{error(row):.2f}"]
        print(f"| {exponent} | " + " | ".join(map(str, cells)) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
