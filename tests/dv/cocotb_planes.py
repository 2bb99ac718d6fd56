# SPDX-License-Identifier: Apache-2.0
"""Builds the RTL of const_depth_rows with Verilator, and runs cocotb_planes_cases: cocotb_planes.py BITSPAN."""

import filecmp
import os
import pathlib
import shutil
import subprocess
import sys

import bitspan
from cocotb import runner

config = pathlib.Path("planes.toml").resolve()
config.write_text(bitspan.Config("depth16").with_({"perspective.mode": "const_depth_rows"}).text)
os.environ.update(MAP=str(pathlib.Path(__file__).resolve().with_name("cocotb_planes.toml")), CONFIG=str(config), MAKEFLAGS="-j2")
fresh, rtl = pathlib.Path("fresh"), pathlib.Path("rtl")
shutil.rmtree(fresh, ignore_errors=True)
subprocess.run([sys.argv[1], "config", "emit-sv", config, "--part", "interpolator", "--rtl", fresh], check=True)
# Files that are the same stay, so that a second run has nothing to compile.
rtl.mkdir(exist_ok=True)
for file in fresh.iterdir():
    if not (rtl / file.name).exists() or not filecmp.cmp(file, rtl / file.name, shallow=False):
        shutil.copyfile(file, rtl / file.name)
simulator = runner.get_runner("verilator")
simulator.build(verilog_sources=[rtl / name for name in (rtl / "bitspan.f").read_text().split()], hdl_toplevel="span_interpolator",
                build_args=["-fno-const-bit-op-tree", "-Wno-lint", "-CFLAGS", "-O0"], build_dir="verilator")
tests, failed = runner.get_results(simulator.test(hdl_toplevel="span_interpolator", test_module="cocotb_planes_cases"))
sys.exit(tests == 0 or failed != 0)
