# SPDX-License-Identifier: Apache-2.0
"""A design under cocotb 1.8 against a model: docs/cocotb.md shows it by example.

    @cocotb.test()
    async def test(dut):
        async with bitspan.cocotb.SpanModel(dut, map="acme.toml") as bench:
            await bench.scene("demo", width=64, height=48)
            await bench.random(rows=200)
"""

from __future__ import annotations

import os
import pathlib
import random
import sys
import tomllib
from types import TracebackType
from typing import Any, Callable, Iterable, Mapping

import cocotb
import numpy as np
from cocotb.handle import ModifiableObject, NonHierarchyIndexableObject
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer
from numpy.typing import NDArray

from ._config import Config
from ._core import InputError
from ._divergence import Divergence
from ._map import DERIVED, Lane, Map, Side, read_map
from ._model import Model
from ._scene import Scene, scene_of

#: What random rows are of.
RANDOM_STAGES = ("edge_walk", "span_setup")

__all__ = ["Map", "SpanModel", "random_config", "read_map"]


def random_config(rng: random.Random, base: Config, settings: Mapping[str, Iterable[Any]], tries: int = 1000) -> Config:
    """Returns a legal configuration: `base` with one of the values that are given per key, such as
    {"formats.span.shade.word": range(8, 14)}.
    """
    choices = {key: list(values) for key, values in settings.items()}
    error: InputError | None = None
    for _ in range(tries):
        try:
            config = base.with_({key: rng.choice(values) for key, values in choices.items()})
            Model(config).close()
            return config
        except InputError as refused:
            error = refused
    raise InputError(f"random_config: no legal configuration in {tries} tries; the last one: {error}")


class _Port:
    """Lanes of one handle: how they are packed and unpacked."""

    def __init__(self, handle: Any, name: str, lanes: list[Lane]):
        self.handle = handle
        self.name = name
        self.bits = len(handle)
        self.lanes = []
        for lane in lanes:
            width = self.bits if lane.width is None else lane.width
            if width < lane.word or lane.shift + width > self.bits:
                raise InputError(f"{name}: has {self.bits} bits; expected {lane.shift + max(width, lane.word)} at least, for "
                                 f"{lane.stage}.{lane.field}")
            self.lanes.append((lane, lane.shift, (1 << width) - 1, 1 << (width - 1) if lane.signed else 0))
        used = sum(lane.width or self.bits for lane in lanes)
        if lanes[0].exact and used != self.bits:
            raise InputError(f"{name}: has {self.bits} bits; expected {used}, those of " + ", ".join(lane.field for lane in lanes))

    def pack(self, value: Callable[[Lane], int]) -> int:
        out = 0
        for lane, shift, mask, sign in self.lanes:
            given = value(lane)
            # An index may have less bits than it needs.
            if lane.word == 0 and not -sign <= given <= mask - sign:
                raise InputError(f"{self.name}: {lane.field} is {given}; expected a value of {mask.bit_length()} bits")
            out |= (given & mask) << shift
        return out

    def read(self) -> int:
        text = self.handle.value.binstr
        try:
            return int(text, 2)
        except ValueError:
            raise AssertionError(f"{self.name}: {text}; expected no x and no z where a record is delivered") from None


def _is_array(handle: Any) -> bool:
    """Whether it is an unpacked array."""
    return isinstance(handle, NonHierarchyIndexableObject) and not isinstance(handle, ModifiableObject)


class SpanModel:
    """Drives a design with rows, takes the records that it delivers with random stalls, and checks each with the model.

    dut     the design, as cocotb gives it
    map     a map file; a relative path is looked up in the working folder, then beside the caller's file
    config  replaces the configuration of the map
    engine  of the model
    seed    of the stalls and the random rows; cocotb's by default. It is printed.
    stalls  probabilities of a clock without a row offered, and of one without a record taken
    period  of the clock [steps of the simulator's precision], which this class drives while one of its methods is awaited;
            None: the bench drives clock and reset

    Inputs change at the clock's falling edge, and outputs are sampled in front of its rising edge. In `async with`, the design
    is reset at the beginning, and finish() comes at the end.
    """

    #: The clocks that the simulation goes on for after the first difference, so that a waveform has it.
    clocks_after_mismatch = 50
    #: The clocks without a record after which the design is taken to have delivered all.
    quiet = 500

    def __init__(self, dut: Any, map: str | os.PathLike[str], config: Config | str | os.PathLike[str] | None = None,
                 engine: str = "model", seed: int | None = None, stalls: tuple[float, float] = (0.25, 0.25), period: int | None = 10):
        self.dut = dut
        path = pathlib.Path(map)
        if not path.exists():
            path = pathlib.Path(sys._getframe(1).f_globals.get("__file__", "")).parent / path
        self.map = read_map(path, config)
        self.config = self.map.config
        self.model = Model(self.config, engine)
        self.seed = cocotb.RANDOM_SEED if seed is None else int(seed)
        self.rng = random.Random(self.seed)
        self.stalls = stalls
        self.first: Divergence | None = None  #: the first difference
        self.different = 0  #: records that differ
        self.clocks = 0
        self.matched = 0  #: values that were equal, of the fields that the design has
        self.nontrivial = 0  #: those of them that are neither 0 nor the field's value in the record before
        self.unchecked = 0  #: records that the design did not deliver
        self._half = None if period is None else Timer(max(1, period // 2), "step")
        if self.map.top != dut._name:
            raise InputError(f"{self.map.path}: top: '{self.map.top}'; expected {dut._name}, the design")
        self._clock = self._handle(self.map.clock)
        self._reset = self._handle(self.map.reset) if self.map.reset else None
        self._inputs = self._ports(self.map.input)
        self._outputs = self._ports(self.map.output)
        self._in_valid = self._handle(self.map.input.valid)
        self._in_ready = self._handle(self.map.input.ready) if self.map.input.ready else None
        self._out_valid = self._handle(self.map.output.valid)
        self._out_ready = self._handle(self.map.output.ready) if self.map.output.ready else None
        stage = self.map.output.stage
        self._columns = [self.model.names(stage).index(lane.field) for port in self._outputs for lane, *_ in port.lanes]
        self._absent = [c for c in range(len(self.model.names(stage))) if c not in self._columns]
        names = self.model.names(stage)
        dut._log.info("bitspan: seed %d, %s%s", self.seed, self.config,
                      "; no port has " + ", ".join(names[c] for c in self._absent) if self._absent else "")

    def _handle(self, name: str) -> Any:
        try:
            return getattr(self.dut, name)
        except AttributeError:
            raise InputError(f"{self.map.path}: '{name}'; expected a port of {self.dut._name}") from None

    def _ports(self, side: Side) -> list[_Port]:
        by_handle: dict[tuple[str, int | None], list[Lane]] = {}
        for lane in side.lanes:
            by_handle.setdefault((lane.port, lane.element), []).append(lane)
        out = []
        for (name, element), lanes in by_handle.items():
            handle = self._handle(name)
            elements = sum(port == name for port, _ in by_handle)
            if (element is not None) != _is_array(handle):
                raise InputError(f"{name}: is {'an' if element is None else 'no'} array; expected "
                                 + ("a list of fields in the map" if element is None else "an array of the fields in the map"))
            if element is not None:
                low, high = sorted(handle._range)
                if high - low + 1 != elements:
                    raise InputError(f"{name}: has {high - low + 1} elements; expected {elements}, one per field")
                handle = handle[low + element]
                name = f"{name}[{low + element}]"
            out.append(_Port(handle, name, lanes))
        return out

    async def reset(self, clocks: int = 4) -> None:
        """Resets the design. Where the bench drives clock and reset, it waits until the reset is over."""
        self._in_valid.value = 0
        for port in self._inputs:
            port.handle.value = 0
        if self._out_ready is not None:
            self._out_ready.value = 0
        if self._half is None:
            await FallingEdge(self._clock)
            while self._reset is not None and self._reset.value.binstr != str(1 - self.map.reset_level):
                await FallingEdge(self._clock)
            return
        for active in (1, 0):
            if self._reset is not None:
                self._reset.value = self.map.reset_level if active else 1 - self.map.reset_level
            for _ in range(clocks):
                self._clock.value = 0
                await self._half
                self._clock.value = 1
                await self._half

    async def scene(self, scene: Scene | str | os.PathLike[str] = "demo", width: int = 0, height: int = 0,
                    rows: int | None = None) -> None:
        """Feeds the rows of a scene, or the first ones alone, where `rows` says how many."""
        if rows is not None and (self.map.output.stage != "span" or self.map.input.stage not in RANDOM_STAGES):
            raise InputError(f"SpanModel.scene: rows: {rows}; expected a map from {' or '.join(RANDOM_STAGES)} to span")
        drawn = scene_of(scene, width, height)
        self.model.begin(drawn)
        self.model.draw(drawn)
        records = self.model.table(self.map.input.stage)[:rows].copy()
        pixels = None
        if rows is not None:
            names = self.model.names(self.map.input.stage)
            pixels = int(records[:, names.index("count")].sum() if "count" in names else
                         (records[:, names.index("x_last")] - records[:, names.index("x_first")] + 1).sum())
        await self._run(records, pixels)

    async def random(self, rows: int = 100, width: int = 64, height: int = 48,
                     constrain: Callable[[random.Random, dict[str, int]], None] | None = None) -> None:
        """Feeds random rows: every register has any value of its format, or one of the ends of the format.

        constrain(rng, row) may change the fields of a row before it is drawn. The pixels must be inside a picture of width x height.
        In const_depth_rows a row belongs to a triangle: the rows are those of rows / 8 random triangles, and cannot be constrained.
        """
        stage = self.map.input.stage
        if tomllib.loads(self.config.text)["perspective"]["mode"] == "const_depth_rows":
            if constrain is not None:
                raise InputError("SpanModel.random: constrain; expected none in const_depth_rows, whose rows belong to triangles")
            return await self.scene(random_triangles(self.rng, max(1, rows // 8), width, height))
        if stage not in RANDOM_STAGES:
            raise InputError(f"SpanModel.random: the map feeds {stage}; expected {' or '.join(RANDOM_STAGES)}")
        self.model.begin(Scene.from_vertices(np.zeros((0, 3, 3)), width, height))
        for _ in range(rows):
            row = random_row(self.rng, self.config, stage, width, height)
            if constrain is not None:
                constrain(self.rng, row)
            self.model.row(stage, row)
        await self._run(self.model.table(stage).copy())

    async def rows(self, records: Any, scene: Scene) -> None:
        """Feeds rows of the caller's: (n, k) int64, or mappings of fields. The pixels must be inside the scene's picture."""
        stage = self.map.input.stage
        self.model.begin(scene)
        for record in records:
            self.model.row(stage, record)
        await self._run(self.model.table(stage).copy())

    def finish(self) -> None:
        """Fails on a difference, on records that the design did not deliver, where nothing matched, and where nothing
        non-trivial matched."""
        counts = (f"{self.matched} values matched, {self.nontrivial} non-trivial, {self.unchecked} records unchecked, "
                  f"{self.different} records differ")
        self.dut._log.info("bitspan: %s", counts)
        if self.first is not None:
            raise AssertionError(f"{self._text()} (seed {self.seed}; {counts})")
        if self.matched == 0 or self.nontrivial == 0 or self.unchecked != 0:
            raise AssertionError(f"not verified: {counts} (seed {self.seed})")

    def _text(self) -> str:
        d = self.first
        assert d is not None
        place = f"{d.stage}: record {d.record}, triangle {d.triangle}, pixel {d.x} {d.y}: "
        if d.field is None:
            return place + "the model has no such record"
        word = self.config.field(f"{d.stage}.{d.field}").word
        got, expected = ((hex(v & ((1 << word) - 1)) if word and -(1 << word) < v < 1 << word else str(v))
                         for v in (d.actual, d.expected))
        return (f"{place}{d.field}: got {got} ({d.actual_value:.9g} {d.unit}), expected {expected} "
                f"({d.expected_value:.9g} {d.unit})")

    async def __aenter__(self) -> SpanModel:
        await self.reset()
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if kind is None:
            self.finish()

    async def _run(self, rows: NDArray[np.int64], records: int | None = None) -> None:
        stage = self.map.output.stage
        # A copy: a view would keep the model from drawing. More than `records` must not come.
        expected = self.model.table(stage)[:records].copy()
        offers = self._offers(rows)
        clock, half, rng, valid, ready = self._clock, self._half, self.rng, self._out_valid, self._out_ready
        no_row, no_take = self.stalls
        next_row = delivered = quiet = 0
        offered = False
        clocks_left: int | None = None
        # Values are set at once: what cocotb schedules costs two thirds more time.
        while quiet < self.quiet and clocks_left != 0:
            if half is None:
                await FallingEdge(clock)
            else:
                clock.setimmediatevalue(0)
            if not offered and next_row < len(offers) and rng.random() >= no_row:
                for port, value in zip(self._inputs, offers[next_row]):
                    port.handle.setimmediatevalue(value)
                offered = True
            self._in_valid.setimmediatevalue(int(offered))
            takes = ready is None or rng.random() >= no_take
            if ready is not None:
                ready.setimmediatevalue(int(takes))
            await (ReadOnly() if half is None else half)
            # The clock rises behind this: these are the values that its edge sees.
            quiet += 1
            if offered and (self._in_ready is None or self._in_ready.value.binstr == "1"):
                offered = False
                next_row += 1
                quiet = 0
            delivers = valid.value.binstr
            if delivers not in ("0", "1"):
                raise AssertionError(f"{self.map.output.valid}: {delivers}; expected 0 or 1 after the reset")
            if takes and delivers == "1":
                if not self._check(expected, delivered) and clocks_left is None:
                    self.dut._log.error("bitspan: first difference: %s", self._text())
                    clocks_left = self.clocks_after_mismatch
                delivered += 1
                quiet = 0
            if clocks_left is not None:
                clocks_left -= 1
            self.clocks += 1
            if half is None:
                await RisingEdge(clock)
            else:
                clock.setimmediatevalue(1)
                await half
        if half is None:
            await FallingEdge(clock)
        self._in_valid.setimmediatevalue(0)
        if ready is not None:
            ready.setimmediatevalue(0)
        self.unchecked += max(0, len(expected) - delivered)
        if self.first is not None:
            self.finish()  # which raises

    def _offers(self, rows: NDArray[np.int64]) -> list[list[int]]:
        """What the input ports have, per row."""
        stage = self.map.input.stage
        constants = {name: int(v) for record in self.model.table("constants") for name, v in
                     zip(self.model.names("constants"), record)}
        triangles = {record[0]: dict(zip(self.model.names("plane_walk"), record)) for record in self.model.table("plane_walk").tolist()}
        names = self.model.names(stage)
        out = []
        for row in rows.tolist():
            values = dict(zip(names, row))
            if (stage, "count") in DERIVED:
                values["count"] = values["x_last"] - values["x_first"] + 1
            of = {stage: values, "constants": constants, "plane_walk": triangles.get(values["triangle"], {})}
            out.append([port.pack(lambda lane: of[lane.stage][lane.field]) for port in self._inputs])
        return out

    def _check(self, expected: NDArray[np.int64], i: int) -> bool:
        """Checks the next record; fields that no port carries are taken from the model, and not counted."""
        stage = self.map.output.stage
        record = np.zeros((1, len(self.model.names(stage))), np.int64)
        nothing = nontrivial = 0
        if i < len(expected):
            record[0] = expected[i]
            for column in self._absent:
                value = expected[i, column]
                nontrivial += int(value != 0 and (i == 0 or value != expected[i - 1, column]))
            nothing = len(self._absent)
        columns = iter(self._columns)
        for port in self._outputs:
            word = port.read()
            for _, shift, mask, sign in port.lanes:
                value = (word >> shift) & mask
                value = (value ^ sign) - sign
                # A value beyond 63 bits is one of 64 bits in two's complement.
                record[0, next(columns)] = value - (1 << 64) if value >> 63 == 1 else value
        before = self.model.matched, self.model.nontrivial
        divergence = self.model.check(stage, record)
        self.matched += self.model.matched - before[0] - nothing
        self.nontrivial += self.model.nontrivial - before[1] - nontrivial
        if divergence is None:
            return True
        self.different += 1
        if self.first is None:
            self.first = divergence
        return False


def random_triangles(rng: random.Random, count: int, width: int, height: int) -> Scene:
    """A scene of random triangles around the picture."""
    def corner() -> list[float]:
        return [rng.uniform(-0.2 * width, 1.2 * width), rng.uniform(-0.2 * height, 1.2 * height), rng.uniform(1, 100),
                rng.uniform(-500, 500), rng.uniform(-500, 500), rng.random(), rng.random(), rng.random(), rng.random()]

    return Scene.from_vertices([[corner() for _ in range(3)] for _ in range(count)], width, height, name="random triangles")


def random_row(rng: random.Random, config: Config, stage: str, width: int, height: int) -> dict[str, int]:
    """A random record of edge_walk or span_setup, whose pixels are inside the picture."""
    first = rng.randrange(width)
    count = rng.randint(1, width - first)
    row = {}
    for field in config.fields(stage):
        low = -(1 << (field.word - 1)) if field.signed else 0
        high = (1 << (field.word - int(field.signed))) - 1 if field.word else 0
        # Short words make values that no other register saturates.
        value = rng.randint(low, high) >> rng.randrange(1 + field.word)
        row[field.name] = rng.choice((rng.randint(low, high), value, value, low, high))
    if "phase" in row:
        row["phase"] = 0  # which only const_depth_rows has
    row["y"] = rng.randrange(height)
    row.update({"x_first": first, "x_last": first + count - 1} if stage == "edge_walk" else {"x": first, "count": count})
    return row
