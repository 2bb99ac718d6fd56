# SPDX-License-Identifier: Apache-2.0
"""A study database as `bitspan study` writes it, small and without bitspan: what the tests of the report read.

Errors follow from widths as they do in the pipeline: each register adds an error of 2^-bits, independent errors add
in squares, and something else is left at the bottom. python3 make_database.py FILE writes it.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import pathlib
import random
import sqlite3
import struct
import sys
import zlib

CONFIG = (pathlib.Path(__file__).resolve().parents[2] / "config" / "depth16.toml").read_text("utf-8")
WIDTHS = {
    "formats.span.h.word": range(26, 37, 2),
    "formats.span.uv.word": range(17, 28, 2),
    "reciprocal.pixel.output.word": range(12, 22, 2),
}
BASE = {"formats.span.h.word": 34, "formats.span.uv.word": 25, "reciprocal.pixel.output.word": 19}
SCENE_SIZE = (96, 72)  # pixels
# What an attacker would call things: must be text in the page.
HOSTILE = "</script><img src=x onerror=alert(1)>"

PLAN = """[study]
name = "spans"
base = "depth16"
scenes = ["demo", "extreme"]

[[vary]]
keys = ["formats.span.h.word"]
from = 26
to = 36
step = 2

[[vary]]
keys = ["formats.span.uv.word", "formats.edge.uv.word"]
values = [[17, 17], [19, 19], [21, 21], [23, 23], [25, 25], [27, 27]]

[[vary]]
keys = ["reciprocal.pixel.output.word"]
values = [12, 14, 16, 18, 20]

[[constraint]]
metric = "span.u.p999"
at_most = 0.25

[[constraint]]
metric = "picture.wrong_order"
at_most = 0

[search]
algorithm = "greedy"
cost = "cost.register_bits"

[report]
budget = true
bounds = true
"""

TABLES = """
CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT);
CREATE TABLE points(hash TEXT PRIMARY KEY, config_hash TEXT, config TEXT, scenes TEXT, status TEXT, message TEXT,
  seconds REAL);
CREATE TABLE metrics(hash TEXT, name TEXT, value REAL, PRIMARY KEY(hash, name));
CREATE TABLE known_metrics(name TEXT PRIMARY KEY, i INTEGER, field TEXT, label TEXT, unit TEXT, better TEXT, role TEXT,
  squares_add INTEGER, meaning TEXT);
CREATE TABLE fields(hash TEXT, stage TEXT, quantity TEXT, unit TEXT, ulp REAL, count INTEGER);
CREATE TABLE registers(hash TEXT, name TEXT, format TEXT, word INTEGER, int INTEGER, signed INTEGER, count INTEGER,
  min REAL, max REAL, used_bits INTEGER, headroom INTEGER, wraps INTEGER, saturations INTEGER, zeros INTEGER,
  octaves TEXT);
CREATE TABLE studies(name TEXT PRIMARY KEY, plan TEXT, kind TEXT, base_hash TEXT, cost TEXT);
CREATE TABLE axes(study TEXT, axis INTEGER, i INTEGER, key TEXT, base TEXT, name TEXT, "offset" INTEGER, PRIMARY KEY(study, axis, i));
CREATE TABLE constraints(study TEXT, i INTEGER, metric TEXT, at_most NUMERIC, at_least NUMERIC, over TEXT, PRIMARY KEY(study, i));
CREATE TABLE scene_metrics(hash TEXT, scene INTEGER, name TEXT, value REAL, PRIMARY KEY(hash, scene, name));
CREATE TABLE expressions(hash TEXT, text TEXT, value REAL, PRIMARY KEY(hash, text));
CREATE TABLE findings(study TEXT, hash TEXT, line TEXT);
CREATE TABLE validation(study TEXT, hash TEXT, scene TEXT, i INTEGER, value REAL, holds INTEGER);
CREATE TABLE study_metrics(study TEXT, i INTEGER, name TEXT, PRIMARY KEY(study, i));
CREATE TABLE study_points(study TEXT, i INTEGER, hash TEXT, settings TEXT, holds INTEGER, PRIMARY KEY(study, i));
CREATE TABLE search_steps(study TEXT, i INTEGER, hash TEXT, cost REAL, holds INTEGER, best INTEGER);
CREATE TABLE certificate(study TEXT, key TEXT, from_value TEXT, to_value TEXT, hash TEXT, failed TEXT, settings TEXT, combination TEXT);
CREATE TABLE combinations(study TEXT, i INTEGER, combination TEXT, hash TEXT, cost REAL, evaluations INTEGER, stopped_by TEXT, minimal INTEGER, failing TEXT, PRIMARY KEY(study, i));
CREATE TABLE measured_costs(study TEXT, i INTEGER, hash TEXT, estimated REAL, error REAL, measured REAL, message TEXT,
  PRIMARY KEY(study, i));
CREATE TABLE recommended(study TEXT, hash TEXT, reason TEXT, verified TEXT);
CREATE TABLE budget(hash TEXT, quantisation TEXT, metric TEXT, base REAL, without REAL, alone REAL);
CREATE TABLE bounds(hash TEXT, place TEXT, unit TEXT, bound REAL, observed REAL);
CREATE TABLE causes(hash TEXT, scene TEXT, i INTEGER, name TEXT, color TEXT, pixels INTEGER);
CREATE TABLE areas(config_hash TEXT, area_key TEXT, family TEXT, placed INTEGER, status TEXT, message TEXT, tools TEXT, luts INTEGER,
  ffs INTEGER, multipliers INTEGER, memory_bits INTEGER, fmax_mhz REAL, seconds REAL,
  PRIMARY KEY(config_hash, family, placed));
CREATE TABLE pictures(hash TEXT, scene TEXT, name TEXT, png BLOB, PRIMARY KEY(hash, scene, name));
"""

# name, i, field, label, unit, better, role, squares_add, meaning
KNOWN_METRICS = [
    (name, i, *rest, "what it means")
    for i, (name, *rest) in enumerate(
        [
            (f"span.{quantity}.{ending}", f"span.{quantity}", label, *how)
            for quantity, unit in (("h", "depth code"), ("u", "texel"))
            for ending, label, *how in (
                ("max", "maximum", unit, "low", "result", 0),
                ("max_ulp", "maximum [ULP]", "ULP", "low", "detail", 0),
                ("rms", "RMS", unit, "low", "result", 1),
                ("p999", "99.9 %", unit, "low", "result", 0),
                ("sqnr_db", "SQNR [dB]", "dB", "high", "result", 0),
            )
        ]
        + [
            (name, "", "", *how, 0)
            for name, *how in (
                ("picture.psnr_db", "dB", "high", "result"),
                ("picture.wrong_order", "pixels", "low", "result"),
                ("picture.wrong_texel_rate", "of the pixels", "low", "result"),
                ("registers.wraps", "values", "low", "result"),
                ("register.span.h.headroom", "bits", "high", "detail"),
                ("cost.register_bits", "bits", "low", "cost"),
                ("cost.product_bits", "bit × bit", "low", "cost"),
                *(
                    (f"area.{family}.{column}", unit, better, "cost")
                    for family in ("ice40", "ecp5")
                    for column, unit, better in (
                        ("luts", "LUTs", "low"),
                        ("ffs", "flip-flops", "low"),
                        ("multipliers", "multipliers", "low"),
                        ("memory_bits", "bits", "low"),
                        ("fmax_mhz", "MHz", "high"),
                    )
                ),
            )
        ]
    )
]


def digest(*parts: object) -> str:
    return hashlib.sha256("|".join(map(str, parts)).encode()).hexdigest()


SCENES = json.dumps([{"name": name, "hash": digest(name)} for name in ("demo", "extreme")])


def stored(value: float) -> float | str | None:
    """As the database keeps numbers that are none."""
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else ("inf" if value > 0 else "-inf")


def config_with(settings: dict[str, int]) -> str:
    """depth16 with the words of the varied keys."""
    text = CONFIG.replace("# depth16:", f"# {digest(settings)[:8]}:", 1)
    for key, word in settings.items():
        name = key.removeprefix("formats.").removesuffix(".word")
        lines = text.split("\n")
        for i, line in enumerate(lines):
            in_unit = key.startswith("reciprocal") and line.startswith("output") and "2^-19" in line
            if line.startswith(f'"{name}" =') or in_unit:
                head, _, tail = line.partition("word = ")
                lines[i] = f"{head}word = {word}{tail[tail.index(',') :]}"
        text = "\n".join(lines)
    return text


def errors_of(settings: dict[str, int]) -> dict[str, float]:
    """RMS errors by cause of u, in texels, and of h, in depth codes."""
    return {
        "span.h": 3e4 * 2.0 ** -(settings["formats.span.h.word"] - 8),
        "span.uv": 2.0 ** -(settings["formats.span.uv.word"] - 17) / 3.4,
        "reciprocal.pixel.output": 900 * 2.0 ** -settings["reciprocal.pixel.output.word"],
        "span.f": 2e-4,
    }


def metrics_of(settings: dict[str, int]) -> dict[str, float]:
    causes = errors_of(settings)
    rms = math.sqrt(sum(e * e for e in causes.values()))
    depth = 2.0 ** -(settings["formats.span.h.word"] - 18)
    bits = 1500 + 6 * settings["formats.span.h.word"] + 8 * settings["formats.span.uv.word"]
    bits += 3 * settings["reciprocal.pixel.output.word"]
    return {
        "span.u.rms": rms,
        "span.u.max": 7 * rms,
        "span.u.p999": 3.3 * rms,
        "span.u.sqnr_db": 20 * math.log10(180 / rms),
        "span.u.max_ulp": 7 * rms * 2**8,
        "span.h.max": 5 * depth,
        "span.h.rms": depth,
        "span.h.p999": 3 * depth,
        "picture.wrong_order": max(0, round(40 * depth - 2)),
        "picture.psnr_db": math.inf if rms < 5e-3 else 30 - 12 * math.log10(rms),
        "picture.wrong_texel_rate": min(1.0, rms * 1.2),
        "register.span.h.headroom": 2,
        "registers.wraps": 0,
        "cost.register_bits": bits,
        "cost.product_bits": 40 * settings["reciprocal.pixel.output.word"] + 900,
        "span.b.rms": math.nan,
    }


def octaves(rng: random.Random, centre: float, spread: float, count: int) -> list[int]:
    """(128,) counts of `count` values spread around 2^centre."""
    counts = [0] * 128
    weights = {e: math.exp(-(((e - centre) / spread) ** 2)) for e in range(-64, 64)}
    total = sum(weights.values())
    for e, weight in weights.items():
        counts[e + 64] = int(count * weight / total + rng.random() * 0.5)
    return counts


def registers_of(settings: dict[str, int]) -> list[tuple]:
    rng = random.Random(7)
    rows = []
    for name, word, integer, signed, centre, spread in (
        ("setup.s", 36, 1, 0, -5, 4),
        ("setup.b", 38, 18, 0, 4, 4),
        ("setup.h", 34, 16, 0, 12, 2.5),
        ("setup.uv", 25, 17, 1, 6, 2.5),
        ("edge.x", 28, 16, 1, 8, 1.5),
        ("edge.h_step", 41, 21, 1, 2, 6),
        ("edge.h", 34, 16, 0, 12, 2.5),
        ("span.h_step", 38, 20, 1, -1, 5),
        ("span.h", settings["formats.span.h.word"], 16, 0, 12, 2.5),
        ("span.f_diff", 40, 34, 1, 14, 5),
        ("span.f_step", 42, 34, 1, 11, 5),
        ("span.f", 42, 34, 1, 15, 5),
        ("reciprocal.pixel.output", settings["reciprocal.pixel.output.word"], 1, 0, -0.6, 0.4),
        ("span.uv", settings["formats.span.uv.word"], 17, 1, 6, 2.5),
        ("span.shade", 13, 1, 0, -1, 1.5),
        ("texture.mix", 12, 8, 0, 6, 1.5),
    ):
        counts = octaves(rng, centre, spread, 300000)
        low, high = integer - word, integer - signed
        counts = [c if low <= i - 64 < high else 0 for i, c in enumerate(counts)]
        if name == "span.f_diff":
            counts[64 + high] = 3  # beyond the format: they saturated
        top = max(i - 64 for i, c in enumerate(counts) if c) + 1
        rows.append(
            (
                name,
                f"{'s' if signed else 'u'}{integer}.{word - integer} SC_RND SC_SAT",
                word,
                integer,
                signed,
                sum(counts) + 900,
                -1.5 * 2.0 ** (top - 1) if signed else 0.0,
                1.5 * 2.0 ** (top - 1),
                top + signed,
                max(0, high - top),
                0,
                3 if name == "span.f_diff" else 0,
                900,
                json.dumps(counts),
            )
        )
    return rows


def png(width: int, height: int, rgb: bytes) -> bytes:
    """An 8-bit RGB picture; rgb is (height, width, 3) bytes."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    rows = b"".join(b"\0" + rgb[3 * width * y : 3 * width * (y + 1)] for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def pictures_of(settings: dict[str, int]) -> dict[str, bytes]:
    """A checkered floor, ideal and with texels moved, and heat maps with a bar of 12 rows below."""
    width, height = SCENE_SIZE
    shift = errors_of(settings)["reciprocal.pixel.output"] * 40

    def floor(x: int, y: int, error: float) -> tuple[int, int, int]:
        if y < height // 4:
            return (90 + y, 130 + y, 190)
        depth = 1 / (y - height / 4 + 1)
        u, v = (x - width / 2) * depth * 30 + error * depth * 9, depth * 400
        return (210, 190, 150) if (int(u // 8) + int(v // 8)) % 2 else (70, 90, 60)

    ideal = [floor(x, y, 0) for y in range(height) for x in range(width)]
    model = [floor(x, y, shift) for y in range(height) for x in range(width)]
    difference = [tuple(min(255, 4 * abs(a - b)) for a, b in zip(p, q)) for p, q in zip(ideal, model)]
    heat = [(20 + 2 * y, 40 + x, 120) for y in range(height) for x in range(width)]
    bar = [(2 * x, 2 * x, 60) for _ in range(12) for x in range(width)]

    def picture(pixels: list, rows: int) -> bytes:
        return png(width, rows, bytes(itertools.chain.from_iterable(pixels)))

    maps = {name: picture(heat + bar, height + 12) for name in ("u_error", "depth_error", "dominant")}
    return {
        "ideal": picture(ideal, height),
        "model": picture(model, height),
        "difference": picture(difference, height),
        **maps,
    }


class Writer:
    """Points of one study in a database."""

    def __init__(self, connection: sqlite3.Connection, study: str) -> None:
        self.connection = connection
        self.study = study
        self.number = 0

    def insert(self, table: str, *rows: tuple) -> None:
        for row in rows:
            self.connection.execute(f"INSERT INTO {table} VALUES ({','.join('?' * len(row))})", row)

    def point(self, settings: dict[str, int], listed: bool = True) -> str:
        """Measures a point, and returns its hash; those too narrow are refused."""
        merged = {**BASE, **settings}
        config = config_with(merged)
        h = digest("point", config)
        if self.connection.execute("SELECT 1 FROM points WHERE hash = ?", (h,)).fetchone() is None:
            self._measure(h, merged, config)
        if listed:
            holds = self.holds(h)
            self.insert("study_points", (self.study, self.number, h, json.dumps(settings), int(holds)))
            self.number += 1
        return h

    def holds(self, h: str) -> bool:
        worst = dict(
            self.connection.execute("SELECT name, max(value) FROM scene_metrics WHERE hash = ? GROUP BY name", (h,))
        )
        return bool(worst) and worst["span.u.p999"] <= 0.25 and worst["picture.wrong_order"] == 0

    def cost(self, h: str) -> float | None:
        row = self.connection.execute(
            "SELECT value FROM metrics WHERE hash = ? AND name = 'cost.register_bits'", (h,)
        ).fetchone()
        return row[0] if row else None

    def _measure(self, h: str, merged: dict[str, int], config: str) -> None:
        narrow = merged["formats.span.uv.word"] < 18
        message = (
            f"formats.span.uv: u reaches 40000 texels on scene demo; 17 bits hold 32768 {HOSTILE}" if narrow else ""
        )
        self.insert(
            "points", (h, digest(config), "" if narrow else config, SCENES, "refused" if narrow else "ok", message, 0.4)
        )
        if narrow:
            return
        metrics = metrics_of(merged)
        self.insert("metrics", *((h, name, stored(value)) for name, value in metrics.items()))
        self.insert("scene_metrics", *scene_metrics_of(h, merged, metrics))
        for quantity, unit in (("u", "texel"), ("h", "depth code")):
            self.insert("fields", (h, "span", quantity, unit, 2.0**-8, 329826))
        self.insert("registers", *((h, *row) for row in registers_of(merged)))


def scene_metrics_of(h: str, settings: dict[str, int], metrics: dict[str, float]) -> list[tuple]:
    """Rows of the constrained metrics: the worse scene has a larger error than both together."""
    factors = (0.8, 1.25) if settings["reciprocal.pixel.output.word"] > 14 else (1.25, 0.8)
    return [
        *((h, scene, "span.u.p999", factor * metrics["span.u.p999"]) for scene, factor in enumerate(factors)),
        (h, 0, "picture.wrong_order", 0),
        (h, 1, "picture.wrong_order", metrics["picture.wrong_order"]),
    ]


def settings_with(h: int, uv: int, output: int) -> dict[str, int]:
    return {
        "formats.span.h.word": h,
        "formats.span.uv.word": uv,
        "formats.edge.uv.word": uv,
        "reciprocal.pixel.output.word": output,
    }


def add_report(writer: Writer, h: str, settings: dict[str, int]) -> None:
    """Budget, bounds and pictures of one point."""
    causes, metrics = errors_of(settings), metrics_of(settings)
    for metric in ("span.u.rms", "span.u.p999", "span.u.max", "span.u.sqnr_db"):
        factor = {"rms": 1, "p999": 3.3, "max": 7}.get(metric.split(".")[-1], 1)
        for name, error in causes.items():
            without = math.sqrt(max(0.0, metrics["span.u.rms"] ** 2 - error**2))
            writer.insert("budget", (h, name, metric, metrics[metric], factor * without, factor * error))
    for place, unit, bound, observed in (
        ("span.h", "depth code", 0.0419, 0.0207),
        ("span.q", "1", 0.061, 0.018),
        ("1/(h+B)", "1", 2.1e-6, 9.4e-7),
        ("span.u", "texel", 0.31, 0.0178),
        ("span.v", "texel", 0.31, 0.0166),
        ("edge.x", "pixel", 2.4e-4, 1.22e-4),
        ("span.shade", "1", 1e-3, 0.0),
    ):
        writer.insert("bounds", (h, place, unit, bound, observed))
    for scene in ("demo", "extreme/needle"):
        writer.insert("pictures", *((h, scene, name, picture) for name, picture in pictures_of(settings).items()))
        writer.insert(
            "causes",
            (h, scene, 0, "reciprocal.pixel.output", "#e69f00", 3600),
            (h, scene, 1, "span.h", "#56b4e9", 1200),
            (h, scene, 2, "span.uv", "#808080", 40),
            (h, scene, 3, "span.f", "#808080", 8),
        )


def search(writer: Writer, base: str) -> tuple[str, dict[str, int]]:
    """Lowers the axis that leaves the most room until nothing can be lowered; returns the found point."""
    axes = [
        list(WIDTHS["formats.span.h.word"]),
        list(WIDTHS["formats.span.uv.word"]),
        list(WIDTHS["reciprocal.pixel.output.word"]),
    ]
    at, step, best = [len(a) - 1 for a in axes], 0, math.inf

    def evaluate(indices: list[int]) -> str:
        nonlocal step, best
        h = writer.point(settings_with(*(a[i] for a, i in zip(axes, indices))), listed=False)
        cost, holds = writer.cost(h), writer.holds(h)
        is_best = holds and cost is not None and cost < best
        best = cost if is_best and cost is not None else best
        writer.insert("search_steps", (writer.study, step, h, cost, int(holds), int(is_best)))
        step += 1
        return h

    found, moved = evaluate(at), True
    while moved:
        moved = False
        for axis in range(3):
            lower = [i - (k == axis) for k, i in enumerate(at)]
            if lower[axis] >= 0 and writer.holds(h := evaluate(lower)):
                at, found, moved = lower, h, True
    names = list(WIDTHS)
    for axis in range(3):
        lower = [i - (k == axis) for k, i in enumerate(at)]
        settings = settings_with(*(a[i] for a, i in zip(axes, lower)))
        h = writer.point(settings, listed=False)
        query = "SELECT max(value) FROM scene_metrics WHERE hash = ? AND name = 'span.u.p999'"
        (worst,) = writer.connection.execute(query, (h,)).fetchone()
        failed = (
            f"fails: span.u.p999 is {worst:.3g}, at most 0.25"
            if worst is not None and worst > 0.25
            else "fails: picture.wrong_order is 2, at most 0"
        )
        writer.insert(
            "certificate",
            (
                writer.study,
                names[axis],
                str(axes[axis][at[axis]]),
                str(axes[axis][lower[axis]]),
                h,
                failed,
                json.dumps(settings),
                "",
            ),
        )
    return found, settings_with(*(a[i] for a, i in zip(axes, at)))


def write_database(path: str | pathlib.Path) -> None:
    """A database with the study "spans" (grid and search) and the study "empty" (nothing measured yet)."""
    pathlib.Path(path).unlink(missing_ok=True)
    connection = sqlite3.connect(path)
    connection.executescript(TABLES)
    writer = Writer(connection, "spans")
    writer.insert("meta", ("schema", "4"), ("version", "0.1.0"))
    writer.insert("known_metrics", *KNOWN_METRICS)
    base = writer.point({})
    for values in itertools.product(*WIDTHS.values()):
        writer.point(settings_with(*values))
    found, settings = search(writer, base)
    writer.insert(
        "studies",
        ("spans", PLAN, "search", base, "cost.register_bits"),
        ("empty", '[study]\nname = "empty"\nbase = "depth16"\n', "sweep", digest("none"), "cost.register_bits"),
    )
    writer.insert(
        "axes",
        ("spans", 0, 0, "formats.span.h.word", "34", "", None),
        ("spans", 1, 0, "formats.span.uv.word", "25", "", None),
        ("spans", 1, 1, "formats.edge.uv.word", "25", "", None),
        ("spans", 2, 0, "reciprocal.pixel.output.word", "19", "", None),
    )
    writer.insert(
        "constraints", ("spans", 0, "span.u.p999", 0.25, None, "worst"), ("spans", 1, "picture.wrong_order", 0, None, "worst")
    )
    writer.insert(
        "recommended",
        (
            "spans",
            found,
            "the cheapest point that holds all constraints",
            "equal: model = golden: 4,218,312 values equal; model = rtl: 1,204,112 values equal",
        ),
    )
    writer.insert(
        "findings",
        ("spans", found, f"span.u.p999 is 0.2408 on demo, at most 0.25: margin 3.7 %; 2 of 2 scenes hold {HOSTILE}"),
        ("spans", found, "validated on 8 views that no point was chosen by: all constraints hold on 7"),
    )
    for i in range(2):  # of the constraints
        for view in range(2, 10):
            value = 0.0 if i else 0.0125 * 2 ** (view / 2)
            writer.insert("validation", ("spans", found, f"demo@{view}", i, value, int(value <= 0.25)))
    add_report(writer, base, BASE)
    add_report(writer, found, settings)
    for h in (base, found):
        (config_hash,) = connection.execute("SELECT config_hash FROM points WHERE hash = ?", (h,)).fetchone()
        small = h == found
        tools = "Yosys 0.23, nextpnr-ice40 0.4"
        writer.insert(
            "areas",
            (
                config_hash,
                digest("area"),
                "ecp5",
                0,
                "ok",
                "",
                tools,
                3100 - 400 * small,
                2210 - 310 * small,
                24,
                12288,
                None,
                21.0,
            ),
            (
                config_hash,
                digest("area"),
                "ice40",
                0,
                "ok",
                "",
                tools,
                8810 - 1520 * small,
                2260 - 290 * small,
                0,
                12288,
                None,
                25.0,
            ),
            (
                config_hash,
                digest("area"),
                "ice40",
                1,
                "ok" if small else "does_not_fit",
                "" if small else "8810 of 7680 LUTs",
                tools,
                7290 if small else None,
                1970 if small else None,
                0,
                12288,
                38.4 if small else None,
                90.0,
            ),
        )
    connection.commit()
    connection.close()


def add_many(path: str | pathlib.Path, count: int) -> None:
    """Adds that many points to the study "spans": what a large grid leaves in a database, without their TOML."""
    rng = random.Random(3)
    connection = sqlite3.connect(path)
    (first,) = connection.execute("SELECT count(*) FROM study_points WHERE study = 'spans'").fetchone()
    writer = Writer(connection, "spans")
    for i in range(first, first + count):
        settings = {**BASE, **settings_with(26 + i % 11, 18 + i // 11 % 10, 12 + i // 110 % 10)}
        metrics = metrics_of(settings)
        for name in ("span.u.p999", "span.u.rms", "span.u.max", "span.h.max"):
            metrics[name] *= 1 + rng.random()
        h = digest("many", i)
        writer.insert("points", (h, digest(h), None, SCENES, "ok", "", 0.01))
        writer.insert("metrics", *((h, name, stored(value)) for name, value in metrics.items()))
        writer.insert("scene_metrics", *scene_metrics_of(h, settings, metrics))
        writer.insert("study_points", ("spans", i, h, json.dumps(settings), int(writer.holds(h))))
    connection.commit()
    connection.close()


if __name__ == "__main__":
    write_database(sys.argv[1])
