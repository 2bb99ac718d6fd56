#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""clang-tidy over sources that a compilation database has, on all cores, the largest first.

  tests/gate/tidy.py DATABASE CHECKS FILE...

A source that was clean is not read again: the hash of all the text that its compiler reads, comments included, names a
stamp in the user's cache. Prints what clang-tidy says; exit code 1 where it says something.
"""
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
STAMPS = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "bitspan" / "tidy"


@functools.cache
def digest(path):
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


def stamp_of(commands, settings):
    """Its name. Empty where the source does not compile: then there is nothing to remember."""
    text = [*settings]
    for command in commands:
        words = shlex.split(command["command"])
        del words[words.index("-o"):words.index("-o") + 2]
        words = [word for word in words if word != "-c" and not word.endswith("ccache")]
        done = subprocess.run([*words, "-M", "-MT", "x"], cwd=command["directory"], capture_output=True, text=True)
        if done.returncode != 0:
            return ""
        read = done.stdout.replace("\\\n", " ").split()[1:]
        text += [" ".join(words).replace(str(ROOT), ""), *(digest(os.path.join(command["directory"], path)) for path in read)]
    return hashlib.sha256("\n".join(text).encode()).hexdigest() if commands else ""


def tidy(folder, commands, checks, file, settings):
    stamp = stamp_of(commands, settings)
    if stamp and (STAMPS / stamp).exists():
        return ""
    done = subprocess.run(["clang-tidy", "--quiet", f"--checks={checks}", "--extra-arg=-Wno-unknown-warning-option",
                           "-p", folder, file], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    if done.returncode == 0 and stamp:
        STAMPS.mkdir(parents=True, exist_ok=True)
        (STAMPS / stamp).touch()
    return done.stdout or f"{file}: clang-tidy exits {done.returncode}\n" if done.returncode else ""


def main():
    folder, checks, *files = sys.argv[1:]
    commands = {file: [] for file in files}
    for entry in json.loads((pathlib.Path(folder) / "compile_commands.json").read_text()):
        commands.get(entry["file"], []).append(entry)
    version = subprocess.run(["clang-tidy", "--version"], check=True, capture_output=True, text=True).stdout
    settings = [version, checks, (ROOT / ".clang-tidy").read_text()]
    files.sort(key=os.path.getsize, reverse=True)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        said = list(pool.map(lambda file: tidy(folder, commands[file], checks, file, settings), files))
    print("".join(said), end="")
    sys.exit(1 if any(said) else 0)


if __name__ == "__main__":
    main()
