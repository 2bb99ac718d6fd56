#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Show which bias a shadow map needs at 12 to 24 bits of depth, as rays from the light judge it.

    bitspan study config/studies/shadow.toml --csv-scenes shadow.csv
    examples/shadow/bias.py shadow.csv shadow-bias.png

prints the tables of docs/studies/shadow.md and draws its picture.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot  # noqa: E402 (the backend comes first)


def read(path: str) -> dict[str, dict[str, dict[int, dict[str, str]]]]:
    """The lines of the CSV file by scene, bias and bits."""
    out: dict[str, dict[str, dict[int, dict[str, str]]]] = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            scene, bias = row["scene"].split(" ")[0], row["scene"].split("--shadow-bias=")[1]
            out.setdefault(pathlib.Path(scene).stem, {}).setdefault(bias, {})[int(row["bits"])] = row
    return out


def table(title: str, head: str, rows: dict[str, dict[int, dict[str, str]]], metric: str) -> str:
    bits = sorted(next(iter(rows.values())))
    lines = [title, "", f"| {head} | " + " | ".join(f"{n} bits" for n in bits) + " |", "|---|" + "---:|" * len(bits)]
    lines += [f"| {name} | " + " | ".join(row[n][metric] for n in bits) + " |" for name, row in rows.items()]
    return "\n".join([*lines, ""])


def main() -> int:
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    scenes = read(sys.argv[1])
    for name, biases in scenes.items():
        print(table(f"{name}: unexplained pixels", "bias", biases, "shadow.unexplained"))
    edges = {name: biases["auto"] for name, biases in scenes.items()}
    print(table("auto", "pixels at a shadow's edge, auto", edges, "shadow.edges"))
    figure, axes = matplotlib.pyplot.subplots(1, len(scenes), figsize=(9, 3.6), sharey=True, layout="constrained")
    for axis, (name, biases) in zip(axes, scenes.items()):
        for bias, rows in biases.items():
            axis.plot(sorted(rows), [int(rows[n]["shadow.unexplained"]) for n in sorted(rows)], marker="o", label=bias)
        axis.set(title=name, xlabel="depth.bits", yscale="symlog", xticks=sorted(rows), ylim=(-0.2, None))
    axes[0].set_ylabel("unexplained pixels")
    axes[-1].legend(title="bias, texels", bbox_to_anchor=(1.02, 1), loc="upper left")
    figure.savefig(sys.argv[2], dpi=100)
    return 0


if __name__ == "__main__":
    sys.exit(main())
