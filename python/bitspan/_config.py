# SPDX-License-Identifier: Apache-2.0
"""Configurations."""

from __future__ import annotations

import json
import os
from typing import Any, Mapping, NamedTuple

import numpy as np

from ._core import ConfigHandle, InputError


class Field(NamedTuple):
    """A field of a stage's records: value = raw * 2**-fraction [unit]."""

    name: str
    word: int  #: bits of the register; 0 for an index, a count or a flag, whose raw value is the value
    fraction: int
    signed: bool
    unit: str  #: "" for an index, a count or a flag


def _toml(path: str, value: Any) -> str:
    """The value of a key as the library takes it."""
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (list, tuple)) and all(isinstance(v, (int, np.integer)) for v in value):
        return json.dumps([int(v) for v in value])
    raise InputError(f"{path}: {value!r} is no value of a configuration; expected an integer, a string, a Boolean, or a list "
                     "of integers")


class Config:
    """A configuration of the pipeline: its modes and the format of each register.

    `source` is the name of a shipped configuration ("depth16"), the path of a TOML file, or the text of one, which
    has more than one line. A configuration never changes, and two are equal where their hashes are.
    """

    __slots__ = ("_fields", "_handle", "_settings")

    def __init__(self, source: str | os.PathLike[str] = "depth16"):
        if isinstance(source, str) and "\n" in source:
            self._handle = ConfigHandle.parse(source)
        elif isinstance(source, (str, os.PathLike)):
            self._handle = ConfigHandle.load(os.fspath(source))
        else:
            raise InputError(f"bitspan.Config: {source!r} is no configuration; expected a name, a path or a text")
        self._settings: dict[str, Any] = {}
        self._fields: dict[str, tuple[Field, ...]] = {}

    def with_(self, settings: Mapping[str, Any]) -> Config:
        """Returns a configuration with keys set, such as {"formats.span.uv.word": 23, "depth.code": "linear"}.

        All keys are set before the rules between them are checked.
        """
        out = object.__new__(Config)
        pairs = [(str(path), _toml(str(path), value)) for path, value in dict(settings).items()]
        out._handle = self._handle.with_settings(pairs)
        out._fields = {}
        out._settings = {**self._settings, **dict(settings)}
        return out

    @property
    def name(self) -> str:
        """The file's stem; no part of the hash."""
        return self._handle.name

    @property
    def hash(self) -> str:
        """16 hexadecimal digits over all that determines results."""
        return self._handle.hash

    @property
    def text(self) -> str:
        """The canonical TOML text, which Config() reads back."""
        return self._handle.text

    def fields(self, stage: str) -> tuple[Field, ...]:
        """Returns the fields of a stage's records, in the order of their columns."""
        if stage not in self._fields:
            self._fields[stage] = tuple(Field(*field) for field in self._handle.fields(stage))
        return self._fields[stage]

    def field(self, name: str) -> Field:
        """Returns a field by "stage.field", such as "span.u"."""
        stage, field = split(name)
        found = [f for f in self.fields(stage) if f.name == field]
        if not found:
            raise InputError(f"{name}: {stage} has no such field; expected one of "
                             + ", ".join(f.name for f in self.fields(stage)))
        return found[0]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Config) and self.hash == other.hash

    def __hash__(self) -> int:
        return hash(self.hash)

    def __reduce__(self) -> tuple[Any, ...]:
        return Config, (self.text,)

    def __repr__(self) -> str:
        settings = "".join(f", {path} = {value}" for path, value in self._settings.items())
        return f"<bitspan.Config {self.name}{settings} ({self.hash})>"


def config_of(config: Config | str | os.PathLike[str]) -> Config:
    """Returns the configuration, or the one that a name, path or text stands for."""
    return config if isinstance(config, Config) else Config(config)


def split(name: str) -> tuple[str, str]:
    """Returns ("setup.edge", "x_step") of "setup.edge.x_step"."""
    stage, dot, field = str(name).rpartition(".")
    if not dot:
        raise InputError(f"{name}: is no field; expected STAGE.FIELD, such as span.u")
    return stage, field
