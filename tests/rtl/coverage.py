#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the random tests of the RTL with Verilator's counters, merges what they leave, and names what was never reached.

  tests/rtl/coverage.py [--configs N] [--seed N] [--no-run] [--module NAME...]

Counters of one module are added over all its instances and configurations, as a cell's parameters make bits constant in
many of them. Verilator 5.006 counts no toggles of signals inside generate blocks; their lines count.
"""
import argparse
import collections
import functools
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = ROOT / "build" / "release" / "tests" / "rtl"
OUT = ROOT / "build" / "coverage"
MERGED = OUT / "merged.dat"
STARTED = OUT / "started.dat"
# What plants bugs, drives illegal inputs or runs other tools says nothing of the RTL as it is.
RUNS = {
    "interpolator": "Interpolator.RandomConfigurations:Interpolator.Depth16:Interpolator.ManyConstantsAndALongSpan",
    "pixel_pipe": "PixelPipe.TheDemo:PixelPipe.RandomDrawStates:PixelPipe.LargePicturesAndTextures:PixelPipe.ResetAmidFragments",
}
KINDS = {"v_line": "lines", "v_branch": "lines", "v_toggle": "toggles", "v_user": "handshakes"}
COLUMNS = ("lines", "toggles", "handshakes")
HANDSHAKES = "_handshakes"

# module, kind: place in the source (0 without), name of the point
Point = collections.namedtuple("Point", "module kind line name")


@functools.cache
def resolved(file):
    """A build tree reaches the RTL through a link."""
    return pathlib.Path(file).resolve()


def parse(lines, root):
    """Returns the count of each point of the RTL below root; what other files have is left out."""
    counts = collections.Counter()
    for text in lines:
        if not text.startswith("C '"):
            continue
        body, _, count = text[3:].rpartition("' ")
        fields = dict(field.split("\x02", 1) for field in body.split("\x01")[1:])
        page, _, where = fields["page"].partition("/")
        module = where.split("__")[0]
        file = resolved(fields["f"])
        if module.endswith(HANDSHAKES):
            if page != "v_user":
                continue
            point = Point(module.removesuffix(HANDSHAKES), KINDS[page], 0, fields["o"])
        elif file.parent == root / "rtl":
            name = fields["o"]
            if page != "v_toggle":
                name = f"{name} at column {fields['n']}"
            point = Point(file.stem, KINDS[page], int(fields["l"]), name)
        else:
            continue
        counts[point] += int(count)
    return counts


def counted(ends, starts, root):
    """Counts at the end; those of toggles from the end of the first reset on."""
    counts = parse(ends, root)
    for point, before in parse(starts, root).items():
        if point.kind == "toggles":
            counts[point] -= before
    return counts


def generate_blocks(text):
    """Returns (label, first line, last line) of each labelled block that has lines of its own."""
    lines = text.splitlines()
    blocks = []
    for first, line in enumerate(lines, 1):
        label = re.search(r"begin : (gen_\w+)", line)
        if not label:
            continue
        indent = line[: len(line) - len(line.lstrip())]
        last = next((n for n in range(first + 1, len(lines) + 1) if re.match(indent + r"end\b", lines[n - 1])), first)
        if last > first:
            blocks.append((label[1], first, last))
    return blocks


def never_built(counts, root):
    """Returns (module, line, label) of each generate block with clocked code that no configuration had."""
    holes = []
    for module in sorted({p.module for p in counts}):
        lines = {p.line for p in counts if p.module == module and p.kind == "lines"}
        text = (root / "rtl" / f"{module}.sv").read_text()
        for label, first, last in generate_blocks(text):
            body = "\n".join(text.splitlines()[first:last - 1])
            if re.search(r"\balways", body) and not any(first <= line <= last for line in lines):
                holes.append((module, first, label))
    return holes


def bits(indices):
    """[3, 2, 1, 7] as "7, 3:1"."""
    ranges = []
    for i in sorted(indices, reverse=True):
        if ranges and ranges[-1][1] == i + 1:
            ranges[-1][1] = i
        else:
            ranges.append([i, i])
    return ", ".join(f"{a}" if a == b else f"{a}:{b}" for a, b in ranges)


def holes_of(counts, module):
    """Returns one line per hole of a module."""
    out = []
    signals = collections.defaultdict(dict)  # by line and name: hit, by the bits' indices
    for point in sorted(p for p in counts if p.module == module):
        hit = counts[point] > 0
        if point.kind == "toggles":
            name, *indices = re.findall(r"[^\[\]]+", point.name)
            signals[point.line, name][tuple(map(int, indices))] = hit
        elif not hit:
            where = f"rtl/{module}.sv" + (f":{point.line}" if point.line else "")
            what = "handshake" if point.kind == "handshakes" else "line"
            out.append(f"{where}: {what}: {point.name}")
    for (line, name), hits in sorted(signals.items()):
        out += [f"rtl/{module}.sv:{line}: toggle: {name}{part}" for part in parts_without(hits)]
    return out


def parts_without(hits):
    """Returns "[7, 3:1]" for the bits of a vector without a hit, and "[9:4][7, 3:1]" for words of an array."""
    missing = [indices for indices, hit in hits.items() if not hit]
    if len(missing) == len(hits):
        return [""]
    if not missing:
        return []
    words = collections.defaultdict(list)  # bits of each word of an array
    for *word, bit in missing:
        words[tuple(word)].append(bit)
    if list(words) == [()]:
        return [f"[{bits(words[()])}]"]
    alike = collections.defaultdict(list)  # words without the same bits
    for word, its_bits in words.items():
        all_of_it = len(its_bits) == sum(1 for indices in hits if indices[:-1] == word)
        alike["" if all_of_it else f"[{bits(its_bits)}]"].append(word)
    return [f"[{bits([w[0] for w in some])}]{part}" for part, some in sorted(alike.items())]


def table(counts, modules):
    """Returns a table of hit and all points per module, with a row of sums."""
    rows = [("module", *COLUMNS)]
    sums = collections.Counter()
    for module in modules:
        cells = []
        for kind in COLUMNS:
            points = [n for p, n in counts.items() if p.module == module and p.kind == kind]
            hit = sum(n > 0 for n in points)
            sums[kind, "hit"] += hit
            sums[kind, "all"] += len(points)
            cells.append(f"{hit}/{len(points)}" if points else "-")
        rows.append((module, *cells))
    rows.append(("all", *(f"{sums[k, 'hit']}/{sums[k, 'all']}" for k in COLUMNS)))
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return "\n".join("  ".join([row[0].ljust(widths[0])] + [c.rjust(w) for c, w in zip(row[1:], widths[1:])]) for row in rows)


def report(counts, root, modules=()):
    """Returns the whole text; `modules` restricts it."""
    known = sorted({p.module for p in counts})
    chosen = [m for m in known if m in modules] if modules else known
    out = [table(counts, chosen), ""]
    holes = [line for m in chosen for line in holes_of(counts, m)]
    holes += [f"rtl/{m}.sv:{n}: never built: {label}" for m, n, label in never_built(counts, root) if m in chosen]
    out += holes or ["no holes"]
    return "\n".join(out)


def run(configs, seed):
    shutil.rmtree(OUT, ignore_errors=True)
    data = OUT / "data"
    data.mkdir(parents=True)
    environment = dict(os.environ, BITSPAN_RTL_COVERAGE=str(data), BITSPAN_RTL_CONFIGS=str(configs),
                       BITSPAN_RTL_SEED=str(seed))
    # One file per simulation; two programs at a time, as a library takes a minute to compile.
    programs = []
    for name, only in RUNS.items():
        log = (OUT / f"{name}.log").open("wb")
        programs.append((name, subprocess.Popen([BUILD / "rtl_test", "--gtest_filter=" + only], env=environment, stdout=log,
                                                stderr=subprocess.STDOUT)))
    failed = [name for name, program in programs if program.wait() != 0]
    if failed:
        sys.exit(f"coverage: {', '.join(failed)} failed; see the logs in {OUT}")
    for merged, ending in ((MERGED, "*.dat"), (STARTED, "*.start")):
        subprocess.run(["verilator_coverage", "--write", merged, *sorted(data.glob(ending))], check=True,
                       stdout=subprocess.DEVNULL)


def main():
    parser = argparse.ArgumentParser(description="Coverage of the RTL by its random tests, with the holes.")
    parser.add_argument("--configs", type=int, default=3, help="random configurations per test (default: 3)")
    parser.add_argument("--seed", type=int, default=1, help="of the first of them (default: 1)")
    parser.add_argument("--no-run", action="store_true", help="report the last run again")
    parser.add_argument("--module", nargs="*", default=[], help="only these modules")
    options = parser.parse_args()
    if not options.no_run:
        run(options.configs, options.seed)
    if not MERGED.exists():
        sys.exit("coverage: there is no run to report")
    with MERGED.open(encoding="utf-8") as ends, STARTED.open(encoding="utf-8") as starts:
        counts = counted(ends, starts, ROOT)
    if not counts:
        sys.exit(f"coverage: no point of the RTL in {MERGED}")
    print(report(counts, ROOT, options.module))


if __name__ == "__main__":
    main()
