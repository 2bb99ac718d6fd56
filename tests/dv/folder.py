# SPDX-License-Identifier: Apache-2.0
"""Where a test of dv/ compiles and runs: a folder below the build, with what an installation would have."""

import os
import pathlib
import re
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(os.environ["BITSPAN_BUILD"])
PREFIX = BUILD / "prefix"


def link(name, target):
    path = PREFIX / name
    path.parent.mkdir(parents=True, exist_ok=True)
    # Tests of one build may run at the same time.
    new = path.with_name(f"{path.name}.{os.getpid()}")
    new.symlink_to(target)
    new.rename(path)


def prepare(name):
    """Returns the folder, which stays, so that a second run has nothing to compile."""
    library = pathlib.Path(os.environ["BITSPAN_LIBRARY"]).resolve()
    link("bin/bitspan", os.environ["BITSPAN_PROGRAM"])
    link("lib/libbitspan.so", library)
    link("lib/libbitspan.so.0", library)
    link("include", SOURCE / "include")
    link("share/bitspan/dv", SOURCE / "dv")
    folder = BUILD / name
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def run(folder, *command, **environment):
    done = subprocess.run([str(word) for word in command], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env={**os.environ, "PREFIX": str(PREFIX), **environment}, encoding="utf-8", errors="replace")
    return done.returncode, done.stdout


def shown(script):
    """Whether docs/dv.md shows a file, all but the comments in front, in at most 15 lines."""
    lines = (SOURCE / script).read_text().splitlines(keepends=True)
    while lines and lines[0].startswith("#"):
        lines.pop(0)
    return len(lines) <= 15 and "".join(lines) in re.findall(r"```\w*\n(.*?)```", (SOURCE / "docs/dv.md").read_text(), re.S)
