# SPDX-License-Identifier: Apache-2.0
"""Models that draw, row by row where a bench wants it, and check records."""

from __future__ import annotations

import functools
import json
import os
from types import TracebackType
from typing import Any, Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._config import Config, config_of
from ._core import InputError
from ._divergence import Divergence
from ._scene import Scene

#: The planes of a picture, by their numbers in the C interface.
PLANES = ("color", "depth", "u", "v", "triangle", "stencil", "position")


@functools.lru_cache(maxsize=None)
def dtype_of(names: tuple[str, ...]) -> np.dtype[np.void]:
    """A record: one int64 per field."""
    return np.dtype([(name, np.int64) for name in names])


def as_records(table: NDArray[np.int64], names: tuple[str, ...]) -> NDArray[np.void]:
    """A view of an (n, k) array as n records with named fields."""
    if len(table) == 0:
        return np.empty(0, dtype_of(names))
    return np.ndarray(len(table), dtype_of(names), table)


def as_table(records: Any, names: tuple[str, ...], what: str) -> NDArray[np.int64]:
    """The (n, k) array of records, which may have names, or be such an array, or a mapping of columns."""
    if isinstance(records, Mapping):
        missing = [name for name in names if name not in records]
        if missing:
            raise InputError(f"{what}: has no column {', '.join(missing)}; expected {', '.join(names)}")
        columns = [np.asarray(records[name]) for name in names]
        if any(column.ndim != 1 or len(column) != len(columns[0]) for column in columns):
            raise InputError(f"{what}: the columns are not of one length; expected (n,) each")
        given = np.stack(columns, axis=1) if len(columns[0]) else np.empty((0, len(names)), np.int64)
    else:
        given = np.asarray(records)
        if given.dtype.names is not None:
            if given.dtype.names != names:
                raise InputError(f"{what}: the fields are {', '.join(given.dtype.names)}; expected {', '.join(names)}")
            given = np.ascontiguousarray(given.reshape(-1))
            if given.dtype != dtype_of(names):
                given = given.astype(dtype_of(names))
            return given.view(np.int64).reshape(-1, len(names))
        if given.size == 0:
            given = np.empty((0, len(names)), np.int64)
        elif given.ndim == 1:
            given = given.reshape(1, -1)
    if given.ndim != 2 or given.shape[1] != len(names):
        raise InputError(f"{what}: the shape is {given.shape}; expected (n, {len(names)})")
    if given.dtype.kind not in "iu" or (given.dtype == np.uint64 and np.any(given > np.uint64(2**63 - 1))):
        raise InputError(f"{what}: has {given.dtype}; expected int64")
    return np.ascontiguousarray(given, np.int64)


class Model:
    """An engine for a configuration: `golden`, `model`, `timed` (with clocks) or `ideal` (the truth; it has no records).

    Views: records() and plane() give arrays that show the model's memory, without a copy. They are read-only, and stay valid
    for as long as they are kept, also after the model is deleted or closed. While one of them lives, begin(), draw(),
    row() and clear_records() raise StateError, since these would change the memory below it. Delete the array
    or copy it first, or use a new Model.

    One model is used by one thread at a time. Different models may be used by different threads, and draw without Python's
    lock. Ctrl-C ends a draw between batches of triangles (not with `timed`); then only begin() may follow.
    """

    def __init__(self, config: Config | str | os.PathLike[str] = "depth16", engine: str = "model"):
        self.config = config_of(config)
        self.engine = str(engine)
        self._core = _core.Model(self.config._handle, self.engine, False)

    def trace(self, on: bool) -> None:
        """Whether records are kept from now on, as they are at first. Without them it is faster."""
        self._core.trace(bool(on))

    def begin(self, scene: Scene) -> None:
        """Begins a picture: clears planes, records and counters. It draws no triangle of the scene."""
        self._core.begin(_handle(scene))

    def draw(self, scene: Scene, frame: int = 0, draw: int = 0) -> None:
        """Draws the scene's triangles, with the changes of state that stand between them. `frame` and `draw` are numbers of the caller's, which a Divergence tells."""
        self._core.draw(_handle(scene), frame, draw)

    def state(self, registers: Mapping[str, str | int | bool] | None = None, *, reset: bool = False) -> None:
        """Changes the draw state for what is drawn from now on: {"depth.func": "lequal", "depth.write": False}.

        docs/formats.md, "Draw state", has the registers; begin() gives each its first value, as reset does.
        """
        self._command({"state": dict(registers or {}), "reset": bool(reset)})

    def clear(self, *, color: Sequence[int] | None = None, alpha: int | None = None, depth: bool = False,
              stencil: int | None = None, masked: bool = False) -> None:
        """Clears planes of the picture: color to (red, green, blue), 0 to 255, depth to the farthest code.

        With masked it clears only inside the scissor, and what the write masks of colour, depth and stencil let through.
        """
        planes = {"color": None if color is None else [c / 255 for c in color], "alpha": alpha, "depth": depth or None,
                  "stencil": stencil, "masked": masked or None}
        self._command({"clear": {name: value for name, value in planes.items() if value is not None}})

    def target(self, k: int) -> None:
        """Draws on target k from now on, 0 to 7: a picture of its own, with its depth buffer. plane() gives that of the target drawn on."""
        self._command({"target": k})

    def view(self, **changes: Any) -> None:
        """Changes the view of the target drawn on: width, height, s_min, s_max, focal, background, 0 to 255, fog, which is None or (color, distance), projector, which is None or (s_min, s_max), and light, which is None or a Light. With another size it is cleared."""
        if changes.get("background") is not None:
            changes["background"] = [c / 255 for c in changes["background"]]
        if changes.get("fog") is not None:
            color, distance = changes["fog"]
            changes["fog"] = {"color": [c / 255 for c in color], "distance": distance}
        if changes.get("projector") is not None:
            changes["projector"] = dict(zip(("s_min", "s_max"), changes["projector"], strict=True))
        if changes.get("light") is not None:
            changes["light"] = changes["light"]._json()
        self._command({"view": changes})

    def copy(self, target: int, plane: str, texture: int) -> None:
        """Makes a plane of a target, "color" or "depth", the texels of a texture of its size, for what is drawn from now on."""
        self._command({"copy": {"target": target, "plane": plane, "texture": texture}})

    def resolve(self) -> None:
        """Merges the candidates that the pixels hold, each the farthest translucent fragment of its pixel: {"translucency.pass": "candidate"} holds them."""
        self._command({"resolve": True})

    def _command(self, command: dict[str, Any]) -> None:
        try:
            self._core.command(json.dumps(command))
        except (TypeError, ValueError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(f"{command}: {error}; expected names, integers and truths") from None

    def row(self, stage: str, record: Any, texture: int = -1) -> None:
        """Draws one row that was made elsewhere, from behind its stage through merge; engines `golden` and `model`.

        stage    "edge_walk" or "span_setup", in const_depth_rows also "plane_walk.row", and "setup" for the triangle of the
                 rows that follow
        record   (k,) int64, a record of the stage, or a mapping of its fields
        texture  index of the scene's, -1 for none
        """
        table = as_table(_one(record), self.names(stage), f"{stage}")
        if len(table) != 1:
            raise InputError(f"{stage}: {len(table)} records; expected one")
        self._core.row(stage, table[0], texture)

    def names(self, stage: str) -> tuple[str, ...]:
        """The fields of a stage's records, in the order of their columns."""
        return tuple(field.name for field in self.config.fields(stage))

    def records(self, stage: str) -> NDArray[np.void]:
        """Returns the stage's records since begin() or clear_records(): (n,) with one int64 per field; a view.

        records("span")["u"] is the column of a field. table() has the same as a plain array.
        """
        return as_records(self._core.records(stage), self.names(stage))

    def table(self, stage: str) -> NDArray[np.int64]:
        """Returns the stage's records as an (n, fields) array of int64; a view."""
        return self._core.records(stage)

    def override(self, stage: str, function: Callable[[tuple[int, ...], list[int]], Sequence[int]] | None) -> None:
        """Puts a function behind a stage of the engine `model`, from the next begin() on; None takes it away.

        function(before, record) gets the record that feeds the stage, and the one that the stage made, in the order of
        names(). It returns the record to use in its place: registers may change within their formats, and so may `covered`,
        `pass` and `killed`. Records behind the stage follow. What it raises ends the draw. `text` then ends with
        "not checked by golden".
        """
        self._core.override(stage, function)

    def clear_records(self) -> None:
        """Forgets the records, so that a long run takes no more memory."""
        self._core.clear_records()

    def plane(self, name: str) -> NDArray[Any]:
        """Returns a plane of the picture, from the top; a view.

        "color"     (H, W, 4) uint8: red, green, blue, alpha, which is 255 at first
        "depth"     (H, W) uint32: the stored code
        "u", "v"    (H, W) float64 [texel]: of the fragment written last; NaN where there is none
        "triangle"  (H, W) int32: the triangle of that fragment; -1 where there is none
        "stencil"   (H, W) uint8; (0, W) before the first stencil test or clear of the stencil
        "position"  (H, W, 3) float64 [unit of s]: the point that the stored code stands for, x to the right, y downward, s;
                    NaN where the code is that of the cleared plane
        """
        if name not in PLANES:
            raise InputError(f"'{name}' is no plane; expected {', '.join(PLANES)}")
        return self._core.plane(PLANES.index(name))

    @property
    def counters(self) -> dict[str, int]:
        """The counters since begin(); "cycles" counts with the engine `timed`."""
        return {name: self._core.counter(name) for name in _core.counters}

    def check(self, stage: str, records: Any) -> Divergence | None:
        """Compares records with the stage's next ones, which those of the calls before came in front of.

        records: (n, fields) int64, or (n,) with named fields, or a mapping of columns. Returns None where all are equal, else the
        first difference.
        """
        found = self._core.check(stage, as_table(records, self.names(stage), stage))
        return None if found is None else Divergence(**found, unit=_unit(self.config, stage, found["field"]))

    @property
    def matched(self) -> int:
        """Values that check() found equal. A bench must fail where it is zero."""
        return self._core.matched

    @property
    def nontrivial(self) -> int:
        """Matched values that are neither 0 nor the same field's value in the record before. A bench must fail on zero."""
        return self._core.nontrivial

    def unchecked(self, stage: str) -> int:
        """Records of the stage that no check() has reached."""
        return self._core.unchecked(stage)

    @property
    def text(self) -> str:
        """What the records are: "engine model, configuration depth16 (c18c9815f835a626)"."""
        return self._core.text

    @property
    def views(self) -> int:
        """How many arrays show the model's memory."""
        return self._core.views

    def close(self) -> None:
        """Ends the model. Its memory is given back with the last array that shows it."""
        self._core.close()

    def __enter__(self) -> Model:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<bitspan.Model {self.text if self._core.is_open else 'closed'}>"


def _one(record: Any) -> Any:
    if isinstance(record, Mapping):
        return {name: np.atleast_1d(value) for name, value in record.items()}
    return record


def _unit(config: Config, stage: str, field: str | None) -> str:
    return "" if field is None else config.field(f"{stage}.{field}").unit


def _handle(scene: Scene) -> _core.SceneHandle:
    if not isinstance(scene, Scene):
        raise InputError(f"{scene!r} is no scene; expected a bitspan.Scene")
    return scene._handle
