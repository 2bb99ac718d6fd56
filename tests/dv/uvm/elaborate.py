# SPDX-License-Identifier: Apache-2.0
"""Elaborates SystemVerilog with pyslang, as its program slang does: elaborate.py ARGUMENT...; prints what it finds, and fails on an
error or a warning."""

import sys

from pyslang import driver

slang = driver.Driver()
slang.addStandardArgs()
good = slang.parseCommandLine(" ".join(["slang", "--single-unit", "-Wextra", "-Wconversion", "-Werror", "--error-limit=0", *sys.argv[1:]]), driver.CommandLineOptions())
sys.exit(not (good and slang.processOptions() and slang.parseAllSources() and slang.runFullCompilation()))
