#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measure which bias a shadow map needs at 12 to 24 bits of depth, as rays from the light judge it.

    examples/shadow/bias.py BITSPAN depth20.toml FOLDER

writes FOLDER/shadow-bias.csv and FOLDER/shadow-bias.png, and prints the tables of docs/studies/shadow.md. Each point is
`bitspan verify SCENE --oracles ray`. The configuration's registers of h keep their places behind a code: with a bit more of depth each
has one more in front.
"""

import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot  # noqa: E402 (the backend comes first)

ROOT = pathlib.Path(__file__).resolve().parents[2]
BITS = [12, 14, 16, 18, 20, 22, 24]
BIASES = ["0", "0.5", "1", "2", "4", "8", "auto"]
SCENES = {
    "demo": ["demo", "--shadow=-12,16,-2,0,2,-26,60"],
    "spot": [str(ROOT / "tests/data/spot.obj"), "--shadow=3,4,-3"],
}
COUNTS = ["equal", "edges", "unexplained"]


def with_depth(bitspan: str, base: str, bits: int) -> str:
    """The configuration with so many bits of depth, and a projector."""
    base_bits = int(re.search(r"^bits *= *(\d+)", base[base.index("[depth]"):], re.M)[1])
    more = bits - base_bits
    if 'unit = "reciprocal"' not in base:
        base = base.replace("[fog]", '[project]\nunit = "reciprocal"\n\n[fog]', 1)
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write(base)
        file.flush()
        table = subprocess.run([bitspan, "config", "show", file.name], check=True, capture_output=True, text=True).stdout
        text = subprocess.run([bitspan, "config", "show", "--toml", file.name], check=True, capture_output=True,
                              text=True).stdout
    # Formats that the text leaves out have defaults, which it then names.
    row = re.compile(r"([\w.]+) +(\d+) +(signed|unsigned) +(-?\d+) +-?\d+ +(SC_\w+) +(SC_\w+) +\S*depth code")
    lines = []
    for name, word, sign, integer, rounding, overflow in (match.groups() for match in map(row.match, table.splitlines()) if match):
        lines.append(f'"{name}" = {{ signed = {"true" if sign == "signed" else "false"}, word = {int(word) + more}, '
                     f'int = {int(integer) + more}, round = "{rounding}", overflow = "{overflow}" }}')
        text = re.sub(rf'^"?{re.escape(name)}"? = .*\n', "", text, flags=re.M)
    assert len(lines) > 20, table
    text = text.replace("[formats]\n", "[formats]\n" + "\n".join(lines) + "\n", 1)
    at = text.index("[depth]")
    return text[:at] + re.sub(r"^bits *= *\d+", f"bits = {bits}", text[at:], count=1, flags=re.M)


def judged(bitspan: str, config: pathlib.Path, scene: list[str], bias: str, out: pathlib.Path) -> dict[str, int]:
    done = subprocess.run([bitspan, "verify", *scene, "--config", str(config), "--size", "160x120", "--engines", "model",
                           "--oracles", "ray", "--shadow-map", "512", "--shadow-bias", bias, "--json", str(out)],
                          capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise SystemExit(done.stderr)
    oracles = json.loads(out.read_text())["scenes"][0]["oracles"]
    return next(oracle for oracle in oracles if oracle["oracle"] == "ray_shadows")


def unexplained(rows: list[dict], name: str, bias: str) -> list[int]:
    return [int(row["unexplained"]) for row in rows if row["scene"] == name and row["bias"] == bias]


def tell(rows: list[dict]) -> None:
    for name in SCENES:
        print(f"\n{name}: unexplained pixels\n\n| bias | " + " | ".join(f"{bits} bits" for bits in BITS) + " |")
        print("|---|" + "---:|" * len(BITS))
        for bias in BIASES:
            print(f"| {bias} | " + " | ".join(str(n) for n in unexplained(rows, name, bias)) + " |")


def plot(rows: list[dict], path: pathlib.Path) -> None:
    figure, axes = matplotlib.pyplot.subplots(1, len(SCENES), figsize=(9, 3.6), sharey=True, layout="constrained")
    for axis, name in zip(axes, SCENES):
        for bias in BIASES:
            axis.plot(BITS, unexplained(rows, name, bias), marker="o", label=bias)
        axis.set(title=name, xlabel="depth.bits", yscale="symlog", xticks=BITS, ylim=(-0.2, None))
    axes[0].set_ylabel("unexplained pixels")
    axes[-1].legend(title="bias, texels", bbox_to_anchor=(1.02, 1), loc="upper left")
    figure.savefig(path, dpi=100)


def main() -> int:
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        return 2
    bitspan, base, out = sys.argv[1], pathlib.Path(sys.argv[2]).read_text(), pathlib.Path(sys.argv[3])
    rows = []
    with tempfile.TemporaryDirectory() as scratch_name:
        scratch = pathlib.Path(scratch_name)
        for bits in BITS:
            config = scratch / f"depth{bits}.toml"
            config.write_text(with_depth(bitspan, base, bits))
            for name, scene in SCENES.items():
                for bias in BIASES:
                    found = judged(bitspan, config, scene, bias, scratch / "out.json")
                    rows.append({"scene": name, "bits": bits, "bias": bias, **{count: found[count] for count in COUNTS}})
                    print(f"{name}, {bits} bits, bias {bias}: {found['unexplained']} unexplained", file=sys.stderr)
    with (out / "shadow-bias.csv").open("w", newline="") as file:
        table = csv.DictWriter(file, rows[0].keys())
        table.writeheader()
        table.writerows(rows)
    tell(rows)
    plot(rows, out / "shadow-bias.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
