# SPDX-License-Identifier: Apache-2.0
"""Runs cocotb_cases: cocotb_run.py verilator|icarus, or cocotb_run.py icarus SEED for a random configuration."""

import os
import pathlib
import random
import sys

import bitspan
import bitspan.cocotb
from cocotb import runner

EXAMPLE = pathlib.Path(__file__).resolve().parent.parent.parent / "examples/cocotb"
os.environ["EXAMPLE"] = str(EXAMPLE)
name, *seed = sys.argv[1:]
parameters = {}
if seed:
    config = bitspan.cocotb.random_config(random.Random(int(seed[0])), bitspan.Config(), {
        "formats.span.h.word": range(30, 39), "formats.span.h_step.word": range(30, 42), "formats.span.f.word": range(38, 48),
        "formats.span.f_step.word": range(36, 48), "formats.span.shade_step.word": range(20, 30),
        "formats.span.shade.word": range(8, 16)})
    print("seed", seed[0], config)
    fields = {field.name: field for field in config.fields("span_setup")}
    words = {"HW": "h", "FW": "fu", "AccW": "r", "HStepW": "h_step", "FStepW": "fu_step0", "StepW": "r_step0"}
    parameters = {key: fields[field].word for key, field in words.items()}
    for key, step, field in (("HShift", "h_step", "h"), ("FShift", "fu_step0", "fu"), ("Shift", "r_step0", "r")):
        parameters[key] = fields[step].fraction - fields[field].fraction
    parameters["ShadeW"] = config.field("span.r").word
    folder = pathlib.Path(f"random{seed[0]}").resolve()
    folder.mkdir(exist_ok=True)
    (folder / "config.toml").write_text(config.text)
    os.environ["CONFIG"] = str(folder / "config.toml")
simulator = runner.get_runner(name)
simulator.build(verilog_sources=[EXAMPLE / "acme_walk.sv"], hdl_toplevel="acme_walk", always=True, parameters=parameters,
                build_dir=f"random{seed[0]}" if seed else name)
tests, failed = runner.get_results(simulator.test(hdl_toplevel="acme_walk", test_module="cocotb_cases",
                                                  testcase="a_random_configuration" if seed else None))
sys.exit(tests == 0 or failed != 0)
