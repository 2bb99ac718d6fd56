# SPDX-License-Identifier: Apache-2.0
# Builds acme_walk and runs its test in the folder that this is called in: run.py verilator|icarus [PARAMETER=VALUE...]
# FLIP=1 is a planted bug.
import pathlib
import sys

from cocotb import runner

here = pathlib.Path(__file__).resolve().parent
simulator = runner.get_runner(sys.argv[1])
simulator.build(verilog_sources=[here / "acme_walk.sv"], hdl_toplevel="acme_walk", build_dir=sys.argv[1], always=True,
                parameters=dict(word.split("=") for word in sys.argv[2:]))
results = simulator.test(hdl_toplevel="acme_walk", test_module="test_acme_walk")
tests, failed = runner.get_results(results)
sys.exit(tests == 0 or failed != 0)
