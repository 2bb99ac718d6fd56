#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the tests of `./dev test` and tells what of them passed, failed and was skipped.

  tests/gate/run.py [CTEST-ARGS...]           the gate, and a share of the long tests that the commit's hash chooses
  tests/gate/run.py --long [CTEST-ARGS...]    everything
  tests/gate/run.py --measure BUILD [REGEX]   prints the CPU seconds of each test alone, for long.toml

long.toml names the tests that the gate leaves out or runs in a shorter form; every other test is in the gate. The builds
are build/release, and for the gate build/readers, for everything build/asan-ubsan. Where BITSPAN_GATE is set, a test runs
its shorter form; where BITSPAN_LONG is set, its longest one.
"""
import fnmatch
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import tomllib
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SHARES = 8
# Seconds of a test that has no TIMEOUT of its own. Those of the gate take at most ten on an idle core.
GATE_TIMEOUT = 300
LONG_TIMEOUT = 7200


def plain(name):
    """A test's name without what GoogleTest says of its parameter."""
    return name.split("  #")[0]


def tests_of(build):
    """The tests of a build, by name: its number for `ctest -I`."""
    out = subprocess.run(["ctest", "--test-dir", ROOT / "build" / build, "--show-only=json-v1"], check=True,
                         capture_output=True, text=True).stdout
    return {plain(test["name"]): number for number, test in enumerate(json.loads(out)["tests"], 1)}


def shares(long):
    """SHARES lists of (build, name) of about equal seconds. `long`: seconds by (build, name)."""
    lists, sums = [[] for _ in range(SHARES)], [0] * SHARES
    for key in sorted(long, key=lambda key: (-long[key], key)):
        least = sums.index(min(sums))
        lists[least].append(key)
        sums[least] += long[key]
    return lists


def check_names(table, known):
    """Exits where long.toml names a test that there is not: its entry would leave nothing out."""
    lost = [f"{build}: {name}" for build in known for part in ("long", "short_form")
            for name in table[build].get(part, {}) if name not in known[build]]
    if lost:
        sys.exit("gate: long.toml names tests that do not exist: " + ", ".join(lost))


def read_results(file):
    """Names that passed, failed and were skipped, of a JUnit file of ctest."""
    results = {"passed": [], "failed": [], "skipped": []}
    for case in xml.etree.ElementTree.parse(file).iter("testcase"):
        kind = {"run": "passed", "notrun": "skipped", "disabled": "skipped"}.get(case.get("status"), "failed")
        # Not run is also what has no program.
        message = case.find("skipped").get("message", "") if case.find("skipped") is not None else ""
        results["failed" if kind == "skipped" and "SKIP" not in message else kind].append(plain(case.get("name")))
    return results


def run(build, numbers, timeout, environment, arguments):
    with tempfile.TemporaryDirectory(prefix="bitspan-gate-") as folder:
        chosen, report = pathlib.Path(folder) / "tests", pathlib.Path(folder) / "results.xml"
        chosen.write_text("1,0,1," + ",".join(map(str, sorted(numbers))) + "\n")
        subprocess.run(["ctest", "--test-dir", ROOT / "build" / build, "-I", chosen, "--output-on-failure", "-j", str(os.cpu_count()),
                        "--timeout", str(timeout), "--output-junit", report, *arguments],
                       env={**os.environ, **environment}, check=False)
        if not report.is_file():
            sys.exit(f"gate: ctest wrote no results of build/{build}")
        return read_results(report)


def say(results, may_skip):
    """Prints the last lines; returns the exit code. `results`: of each run."""
    total = {kind: [name for result in results for name in result[kind]] for kind in ("passed", "failed", "skipped")}
    if total["skipped"]:
        print(f"{len(total['skipped'])} skipped: {', '.join(sorted(set(total['skipped'])))}")
    unlisted = [name for name in total["skipped"] if not any(fnmatch.fnmatchcase(name, pattern) for pattern in may_skip)]
    if unlisted:
        print(f"not listed in long.toml as what may skip, so failed: {', '.join(sorted(set(unlisted)))}")
    if total["failed"]:
        print(f"failed: {', '.join(total['failed'])}")
    failed = len(total["failed"]) + len(unlisted)
    print(f"{len(total['passed'])} passed, {failed} failed", flush=True)
    return 1 if failed or not total["passed"] else 0


def gate(table, arguments):
    known = {build: tests_of(build) for build in ("release", "readers")}
    check_names(table, known)
    # A tree without git has the shares of no commit.
    commit = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True).stdout.strip() or 40 * "0"
    number = int(commit[:8], 16)
    long = {(build, name): seconds for build in known for part in ("long", "short_form")
            for name, seconds in table[build].get(part, {}).items()}
    turn = number % SHARES
    share = shares(long)[turn]
    print(f"share {turn + 1} of {SHARES} of the long tests, by commit {commit[:12]}: "
          f"{', '.join(sorted(f'{build} {name}' for build, name in share))}", flush=True)
    results = []
    for build, numbers in known.items():
        left_out = table[build].get("long", {})
        results.append(run(build, [at for name, at in numbers.items() if name not in left_out], GATE_TIMEOUT,
                           {"BITSPAN_GATE": str(number)}, arguments))
    for build, numbers in known.items():
        names = [name for of, name in share if of == build]
        if names:
            results.append(run(build, [numbers[name] for name in names],
                               max(GATE_TIMEOUT, 10 * max(long[build, name] for name in names)), {}, arguments))
    return say(results, table["may_skip"])


def everything(table, arguments):
    known = {build: tests_of(build) for build in ("release", "asan-ubsan")}
    results = [run(build, numbers.values(), LONG_TIMEOUT, {"BITSPAN_LONG": "1"}, arguments) for build, numbers in known.items()]
    more = {"mutants": [ROOT / "tests/mutants/run"],
            "fuzz": [ROOT / "build/release/cli/bitspan", "fuzz", "--seed", "1", "--pixels", "10000000", "--streams-per-config", "64"]}
    for name, command in more.items():
        code = subprocess.run(command, check=False).returncode
        results.append({"passed": [], "failed": [], "skipped": [], "passed" if code == 0 else "failed": [name]})
    return say(results, table["may_skip"])


def measure(build, pattern):
    for name, number in tests_of(build).items():
        if re.search(pattern, name):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            code = subprocess.run(["ctest", "--test-dir", ROOT / "build" / build, "-I", f"{number},{number}"], check=False,
                                  stdout=subprocess.DEVNULL).returncode
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            print(f"{seconds:7.1f} {name}{'' if code == 0 else '  FAILED'}", flush=True)


def main():
    table = tomllib.loads((pathlib.Path(__file__).parent / "long.toml").read_text())
    arguments = sys.argv[1:]
    if arguments[:1] == ["--measure"]:
        return measure(arguments[1], arguments[2] if len(arguments) > 2 else "")
    if arguments[:1] == ["--long"]:
        return everything(table, arguments[1:])
    return gate(table, arguments)


if __name__ == "__main__":
    sys.exit(main())
