# SPDX-License-Identifier: Apache-2.0
"""The Slurm array of docs/study.md on a cluster of one node that lives in a temporary folder. Exit code 77 where Slurm or MUNGE is missing.

Every daemon dies with this program, and whatever it leaves behind becomes a child of this program and is killed at the end.
"""

import contextlib
import ctypes
import os
import pathlib
import pwd
import re
import shutil
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = os.environ["BITSPAN_PROGRAM"]
PATH = f"{os.environ['PATH']}:/usr/sbin"
SECONDS = 300  # that each daemon, the array and each command may take
PR_SET_CHILD_SUBREAPER = 36

PLAN = """
[study]
name = "grid"
base = "depth16"
scenes = ["demo", "extreme/slivers"]
size = "48x36"

[[vary]]
keys = ["formats.span.f.word"]
from = 34
to = 45

[[vary]]
keys = ["formats.edge.uv.word"]
from = 21
to = 24

[[constraint]]
metric = "span.u.p999"
at_most = 0.25
"""

# Ports are free ones. Processes are found by their group, so that no control group is made. CPUs are those that the file says.
CONF = """
ClusterName=bitspan
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs=2
PartitionName=all Nodes={host} Default=YES
"""


def free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.create_server(("127.0.0.1", 0))) for _ in range(count)]
        return [s.getsockname()[1] for s in sockets]


def kill_all(daemons):
    """Kills the daemons, and then the children of this program until it has none; orphans become its children."""
    for daemon in daemons:
        daemon.kill()
        daemon.wait()
    with contextlib.suppress(ChildProcessError):
        while True:
            for child in pathlib.Path("/proc/self/task", str(os.getpid()), "children").read_text().split():
                os.kill(int(child), signal.SIGKILL)
            os.wait()


def lines_of_the_page():
    """The two lines of the array, and what follows when it is done: merge, and report."""
    page = (SOURCE / "docs/study.md").read_text()
    array = re.search(r"Under Slurm two lines do it.*?\n\n((?: {4}.*\n)+)", page)[1]
    after = re.findall(r"^ {4}(bitspan study (?:merge .*|grid\.toml --db grid\.db --report .*))$", page, re.M)
    return [line.strip() for line in array.splitlines()], after


def rows(database):
    """The rows of every table and view with names in place of numbers of its own, without seconds."""
    out = {}
    with contextlib.closing(sqlite3.connect(f"file:{database}?mode=ro", uri=True)) as connection:
        tables = {name for name, in connection.execute("SELECT name FROM sqlite_master WHERE type IN ('table', 'view')")}
        for table in tables - {"point_rows", "scene_sets", "asks", "metric_names", "metric_values"}:
            columns = [f'"{row[1]}"' for row in connection.execute(f"PRAGMA table_info({table})") if row[1] != "seconds"]
            out[table] = sorted(connection.execute(f"SELECT {', '.join(columns)} FROM {table}"), key=repr)
    return out


class Slurm(unittest.TestCase):
    maxDiff = 2000

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="bitspan-slurm-")
        self.addCleanup(folder.cleanup)
        self.folder, self.daemons = pathlib.Path(folder.name), []
        self.addCleanup(kill_all, self.daemons)
        self.folder.chmod(0o711)  # else MUNGE refuses it
        for name in ("state", "spool", "bin", "work"):
            (self.folder / name).mkdir()
        (self.folder / "bin/bitspan").symlink_to(PROGRAM)
        (self.folder / "work/grid.toml").write_text(PLAN)
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf"),
                            "PATH": f"{self.folder}/bin:{PATH}"}

    def run_here(self, *command):
        run = subprocess.run(command, cwd=self.folder / "work", env=self.environment, capture_output=True, text=True, timeout=SECONDS)
        self.assertEqual(run.returncode, 0, f"{command}: {run.stdout}{run.stderr}")
        return run.stdout

    def start(self, daemon, *arguments):
        with open(self.folder / f"{daemon}.out", "w") as out:
            self.daemons.append(subprocess.Popen(["setpriv", "--pdeathsig", "KILL", daemon, *arguments], cwd=self.folder, env=self.environment,
                             stdin=subprocess.DEVNULL, stdout=out, stderr=out))

    def wait_until(self, what, ready):
        end = time.monotonic() + SECONDS
        while not ready():
            if time.monotonic() > end or any(daemon.poll() is not None for daemon in self.daemons):
                logs = [f"{log.name}:\n{log.read_text()[-2000:]}" for log in self.folder.rglob("*") if log.suffix in (".log", ".out")]
                self.fail(f"no {what} in {SECONDS} s\n" + "\n".join(logs))
            time.sleep(0.1)

    def start_cluster(self):
        (self.folder / "munge.key").touch(mode=0o600)
        (self.folder / "munge.key").write_bytes(os.urandom(128))
        self.start("munged", "--foreground", *(f"--{name}={self.folder}/munge.{name.split('-')[0]}" for name in
                                               ("key-file", "log-file", "pid-file", "seed-file", "socket")))
        self.wait_until("MUNGE", (self.folder / "munge.socket").exists)
        (self.folder / "slurm.conf").write_text(CONF.format(
            folder=self.folder, host=socket.gethostname().split(".")[0], ports=free_ports(2),
            user=pwd.getpwuid(os.getuid()).pw_name))
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        self.wait_until("idle node", lambda: "idle" in subprocess.run(
            ["sinfo", "--noheader", "--format=%T"], env=self.environment, capture_output=True, text=True).stdout.split())

    def test_an_array_measures_what_one_process_does(self):
        array, (merge, report) = lines_of_the_page()
        self.assertEqual(len(array), 2)
        parts = int(re.fullmatch(r"#SBATCH --array=1-(\d+)", array[0])[1])
        self.start_cluster()
        (self.folder / "work/grid.sh").write_text("\n".join(["#!/bin/sh", *array, ""]))
        self.run_here("sbatch", "grid.sh")
        self.wait_until("end of the array", lambda: not self.run_here("squeue", "--noheader").strip())
        said = "".join(file.read_text() for file in (self.folder / "work").glob("slurm-*.out"))
        self.assertEqual(said.count("is finished; with all others"), parts, said)
        self.run_here("sh", "-c", merge)
        self.assertRegex(self.run_here("sh", "-c", report), r"grid: (\d+) points: \1 of them known")
        self.run_here("bitspan", "study", "grid.toml", "--db", "one.db", "--report", "out/one")
        of_parts, of_one = rows(self.folder / "work/grid.db"), rows(self.folder / "work/one.db")
        self.assertGreater(len(of_one["metrics"]), 10000)
        for table, wanted in of_one.items():
            self.assertEqual(of_parts[table], wanted, table)


if __name__ == "__main__":
    if not all(shutil.which(daemon, path=PATH) for daemon in ("munged", "slurmctld", "slurmd")):
        print("skipped: Slurm or MUNGE is missing")
        sys.exit(77)
    ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    unittest.main()
