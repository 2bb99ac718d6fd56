# SPDX-License-Identifier: Apache-2.0
"""Maps: TOML files that bind the ports of a design to fields of records. docs/cocotb.md has the format."""

from __future__ import annotations

import os
import pathlib
import re
import tomllib
from dataclasses import dataclass
from typing import Any

from ._config import Config
from ._core import InputError
from ._core import stages as STAGES

#: What edge_walk's records do not have, but a design is fed with.
DERIVED = {("edge_walk", "count")}


@dataclass(frozen=True)
class Lane:
    """A field in a port: `width` bits from `shift` on of the port, or of an element of an array; None: all of them."""

    port: str
    element: int | None  #: of an unpacked array
    stage: str
    field: str
    signed: bool
    shift: int
    width: int | None
    word: int  #: of the field; 0 for an index, a count or a flag


@dataclass(frozen=True)
class Side:
    stage: str
    valid: str
    ready: str | None
    lanes: tuple[Lane, ...]


@dataclass(frozen=True)
class Map:
    path: pathlib.Path
    top: str
    config: Config
    sources: tuple[pathlib.Path, ...]
    parameters: dict[str, Any]
    clock: str
    reset: str | None
    reset_level: int  #: of the reset while it is active
    input: Side
    output: Side


class _Reader:
    """A file, whose faults are told with line and key."""

    def __init__(self, path: pathlib.Path):
        self.path = path
        try:
            self.text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{path}: cannot read: {getattr(error, 'strerror', None) or error}; expected a map") from None
        try:
            self.values = tomllib.loads(self.text)
        except tomllib.TOMLDecodeError as error:
            at = re.search(r"\(at line (\d+)", str(error))
            line = at[1] if at else str(self.text.count("\n") + 1)
            raise InputError(f"{path}:{line}: {str(error).split(' (at')[0]}; expected TOML") from None

    def line(self, key: str) -> int:
        """The line of a key such as "input.ports.req_x"; that of its table, or the last one, where the key is missing."""
        table, best = "", 0
        for number, text in enumerate(self.text.splitlines(), 1):
            if header := re.match(r"\s*\[\s*([\w.\-]+)\s*\]", text):
                table = header[1] + "."
                if key.startswith(table):
                    best = number
                if key + "." == table:
                    return number
            elif (name := re.match(r"\s*[\"']?([\w.\-\[\]]+)[\"']?\s*=", text)) and (
                    key == table + name[1] or key.startswith(table + name[1] + ".")):
                return number
        return best or max(1, self.text.count("\n"))

    def fault(self, key: str, what: str, expected: str) -> InputError:
        return InputError(f"{self.path}:{self.line(key)}: {key}: {what}; expected {expected}")

    def keys(self, table: dict[str, Any], prefix: str, known: tuple[str, ...]) -> None:
        for key in table:
            if key not in known:
                raise self.fault(prefix + key, "is no key of a map", f"one of {', '.join(known)}")

    def get(self, table: dict[str, Any], key: str, kind: type, expected: str, default: Any = None, needed: bool = True) -> Any:
        name = key.rpartition(".")[2]
        if name not in table:
            if needed:
                raise self.fault(key, "is missing", expected)
            return default
        value = table[name]
        if not isinstance(value, kind) or (kind is int and isinstance(value, bool)) or value == "":
            raise self.fault(key, f"{value!r}", expected)
        return value


def read_map(path: str | os.PathLike[str], config: Any = None) -> Map:
    """Reads a map. `config` replaces the configuration that it names."""
    r = _Reader(pathlib.Path(path))
    top = r.values
    r.keys(top, "", ("top", "config", "sources", "parameters", "clock", "reset", "reset_active", "input", "output"))
    if config is None:
        config = _config(r, r.get(top, "config", str, "a shipped configuration or a TOML file", "depth16", needed=False))
    elif not isinstance(config, Config):
        config = Config(config)
    sources = r.get(top, "sources", list, "a list of files", [], needed=False)
    if not all(isinstance(source, str) for source in sources):
        raise r.fault("sources", f"{sources!r}", "a list of files")
    active = r.get(top, "reset_active", str, '"low" or "high"', "low", needed=False)
    if active not in ("low", "high"):
        raise r.fault("reset_active", f"{active!r}", '"low" or "high"')
    return Map(r.path, r.get(top, "top", str, "the name of a module"), config,
               tuple((r.path.parent / source).resolve() for source in sources),
               r.get(top, "parameters", dict, "a table of parameters", {}, needed=False),
               r.get(top, "clock", str, "the name of a port"),
               r.get(top, "reset", str, "the name of a port", needed=False), int(active == "high"),
               _side(r, "input", config), _side(r, "output", config))


def _config(r: _Reader, name: str) -> Config:
    beside = r.path.parent / name
    try:
        return Config(beside if beside.suffix == ".toml" and beside.exists() else name)
    except InputError as error:
        raise InputError(f"{r.path}:{r.line('config')}: config: {error}") from None


def _side(r: _Reader, name: str, config: Config) -> Side:
    table = r.get(r.values, name, dict, "a table")
    r.keys(table, f"{name}.", ("stage", "valid", "ready", "ports"))
    stage = r.get(table, f"{name}.stage", str, "a stage")
    if stage not in STAGES:
        raise r.fault(f"{name}.stage", f"'{stage}' is no stage", f"one of {', '.join(STAGES)}")
    ports = r.get(table, f"{name}.ports", dict, "a table of ports")
    if not ports:
        raise r.fault(f"{name}.ports", "is empty", "one port at least")
    lanes: list[Lane] = []
    for port, value in ports.items():
        lanes += _lanes(r, config, name, stage, port, value)
    if name == "output":
        seen: dict[str, str] = {}
        for lane in lanes:
            if lane.field in seen:
                raise r.fault(f"output.ports.{lane.port}", f"'{lane.field}' is at {seen[lane.field]} already",
                              "each field at one port")
            seen[lane.field] = lane.port
    return Side(stage, r.get(table, f"{name}.valid", str, "the name of a port"),
                r.get(table, f"{name}.ready", str, "the name of a port", needed=False), tuple(lanes))


def _lanes(r: _Reader, config: Config, side: str, stage: str, port: str, value: Any) -> list[Lane]:
    key = f"{side}.ports.{port}"
    form = "a field, a list of fields, { field = ..., width = ... } or { fields = [...], width = ... }"
    width = None
    packed = array = False
    fields: Any
    if isinstance(value, str):
        fields = [value]
    elif isinstance(value, list):
        fields, array = value, True
    elif isinstance(value, dict):
        r.keys(value, f"{key}.", ("field", "fields", "width"))
        width = r.get(value, f"{key}.width", int, "a number of bits from 1 to 64", needed=False)
        if width is not None and not 1 <= width <= 64:
            raise r.fault(f"{key}.width", f"{width}", "a number of bits from 1 to 64")
        if ("field" in value) == ("fields" in value):
            raise r.fault(key, "has both or none of field and fields", form)
        packed = "fields" in value
        fields = value["fields"] if packed else [value["field"]]
    else:
        fields = None
    if not isinstance(fields, list) or not fields or not all(isinstance(field, str) for field in fields):
        raise r.fault(key, f"{value!r}", form)
    out: list[Lane] = []
    shift = 0
    for i, name in reversed(list(enumerate(fields))):  # the rightmost lane begins at bit 0
        of, _, field = name.rpartition(".")
        of = of or stage
        if side == "output" and of != stage:
            raise r.fault(key, f"'{name}' is of another stage", f"a field of {stage}")
        if of not in (stage, "constants"):
            raise r.fault(key, f"'{name}' is of another stage", f"a field of {stage} or of constants")
        found = [f for f in config.fields(of) if f.name == field]
        if not found and not (side == "input" and (of, field) in DERIVED):
            raise r.fault(key, f"{of} has no field '{field}'", "one of " + ", ".join(f.name for f in config.fields(of)))
        word = found[0].word if found else 0
        if packed and not (width or word):
            raise r.fault(key, f"'{field}' has no word of its own", "a width")
        bits = width or (word if packed else None)
        if bits is not None and bits < word:
            raise r.fault(key, f"width {bits}", f"at least the {word} bits of {of}.{field}")
        # Exponents are indices that may be negative.
        signed = found[0].signed or field.endswith("recip_e") if found else False
        out.append(Lane(port, i if array else None, of, field, signed, shift if packed else 0, bits, word))
        shift += bits or 0
    return out[::-1]
