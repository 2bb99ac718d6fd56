# SPDX-License-Identifier: Apache-2.0
"""A scene that was drawn."""

from __future__ import annotations

import functools
import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._config import Config, config_of, split
from ._core import InputError
from ._model import Model
from ._scene import Scene, scene_of


class _Kept(Model):
    """A model whose memory the next one of the same configuration and engine takes over, when no array shows it any more."""

    def __init__(self, config: Config, engine: str):
        self.config = config
        self.engine = engine
        self._core = _core.Model(config._handle, engine, True)


class Run:
    """A scene drawn by an engine: its picture, its records, its errors. render() makes it.

    Every array of records or of a plane is a read-only view of the run's memory, and not a copy. It holds as long as
    it is kept, also after the run is deleted: a run has a model of its own, which never draws again.

    A stage's records are an attribute too, (n,) with one int64 per field: `run.span["u"]`, `run.setup_edge`, ... The attribute
    `depth` is the plane; the records of that stage are records("depth").
    """

    def __init__(self, scene: Scene, config: Config, engine: str, trace: bool):
        self.scene = scene
        self.config = config
        self.engine = engine
        self._model = _Kept(config, engine)
        self._model.trace(trace)
        self._model.begin(scene)
        self._model.draw(scene)

    @property
    def color(self) -> NDArray[np.uint8]:
        """(H, W, 4) uint8: red, green, blue, 255."""
        return self._model.plane("color")

    @property
    def depth(self) -> NDArray[np.uint32]:
        """(H, W) uint32: the stored depth code."""
        return self._model.plane("depth")

    @property
    def u(self) -> NDArray[np.float64]:
        """(H, W) float64 [texel], of the fragment written last; NaN where there is none."""
        return self._model.plane("u")

    @property
    def v(self) -> NDArray[np.float64]:
        """(H, W) float64 [texel], of the fragment written last; NaN where there is none."""
        return self._model.plane("v")

    @property
    def position(self) -> NDArray[np.float64]:
        """(H, W, 3) float64 [unit of s]: the point that each stored code stands for; NaN where it is that of the cleared plane."""
        return self._model.plane("position")

    @property
    def triangle(self) -> NDArray[np.int32]:
        """(H, W) int32: the index of the triangle written last; -1 where there is none."""
        return self._model.plane("triangle")

    def names(self, stage: str) -> tuple[str, ...]:
        """The fields of a stage's records, in the order of their columns."""
        return self._model.names(stage)

    def records(self, stage: str) -> NDArray[np.void]:
        """Returns a stage's records: (n,) with one int64 per field, raw; a view."""
        return self._model.records(stage)

    def table(self, stage: str) -> NDArray[np.int64]:
        """Returns a stage's records as an (n, fields) array of int64, raw; a view."""
        return self._model.table(stage)

    def __getattr__(self, name: str) -> NDArray[np.void]:
        stage = {s.replace(".", "_"): s for s in _core.stages}.get(name)
        if stage is None or name.startswith("_"):
            raise AttributeError(f"bitspan.Run has no attribute {name!r}")
        return self.records(stage)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(s.replace(".", "_") for s in _core.stages)]

    def real(self, name: str) -> NDArray[np.float64]:
        """Returns a field decoded, "span.u": (n,) float64, raw * 2**-fraction, in the unit of config.field(name)."""
        field = self.config.field(name)
        stage, column = split(name)
        return np.asarray(self.records(stage)[column] * 2.0**-field.fraction)

    def error(self, name: str) -> NDArray[np.float64]:
        """Returns engine - ideal of each record of a field, "span.u": (n,) float64, in the field's unit.

        It is NaN for what a study does not count: pixels that are not covered, killed ones, fog that is off.
        """
        stage, column = split(name)
        self.config.field(name)
        return _core.errors(self.config._handle, self.scene._handle, stage, column, self.table(stage))

    def error_map(self, name: str) -> NDArray[np.float64]:
        """Returns engine - ideal at each pixel, (H, W) float64; NaN where there is none.

        "span.u", "depth.z", "texture.r", "fog.factor" ...: a field of a stage that has a record per pixel, of the fragment that the
        picture shows.
        "picture.u", "picture.v", "picture.depth": of the finished pictures, where both show the same triangle.
        "picture.color": the largest difference of a channel [colour code], everywhere.
        """
        stage, column = split(name)
        if stage == "picture":
            return self._picture_error(column)
        error = self.error(name)
        records = self.records(stage)
        if "x" not in self.names(stage) or stage == "span_setup":
            raise InputError(f"{name}: {stage} has no record per pixel; expected a field of span, depth, texture or fog")
        out = np.full((self.scene.height, self.scene.width), np.nan)
        x, y = records["x"], records["y"]
        # Where a triangle covers a pixel twice, the last one is shown, and the last one is assigned.
        shown = (self.triangle[y, x] == records["triangle"]) & ~np.isnan(error)
        out[y[shown], x[shown]] = error[shown]
        return out

    def _picture_error(self, plane: str) -> NDArray[np.float64]:
        if plane not in ("u", "v", "depth", "color"):
            raise InputError(f"picture.{plane}: expected picture.u, picture.v, picture.depth or picture.color")
        own, ideal = getattr(self, plane).astype(np.float64), getattr(self.ideal, plane).astype(np.float64)
        if plane == "color":
            return np.asarray(np.abs(own - ideal).max(axis=2))
        same = (self.triangle >= 0) & (self.triangle == self.ideal.triangle)
        return np.where(same, own - ideal, np.nan)

    @functools.cached_property
    def ideal(self) -> Run:
        """The same scene and configuration drawn by `ideal`, without quantisation."""
        return Run(self.scene, self.config, "ideal", False)

    @functools.cached_property
    def counters(self) -> dict[str, int]:
        """What the engine counted; "cycles" with the engine `timed`."""
        return self._model.counters

    @property
    def text(self) -> str:
        """What the records are: "engine model, configuration depth16 (c18c9815f835a626)"."""
        return self._model.text

    def __repr__(self) -> str:
        return f"<bitspan.Run of {self.scene.name}, {self.scene.width} x {self.scene.height}: {self.text}>"

    def _repr_png_(self) -> bytes | None:
        try:
            import io

            from matplotlib import image
        except ImportError:
            return None
        out = io.BytesIO()
        image.imsave(out, self.color, format="png")
        return out.getvalue()


def render(scene: Scene | str | os.PathLike[str], config: Config | str | os.PathLike[str] = "depth16", engine: str = "model",
           trace: bool = True, width: int = 0, height: int = 0) -> Run:
    """Draws a scene.

    scene          a Scene, or what Scene() takes, with the width and height of the picture [pixel]
    config         a Config, or what Config() takes
    engine         golden, model, timed or ideal
    trace          whether records are kept; without them it is faster
    """
    return Run(scene_of(scene, width, height), config_of(config), str(engine), bool(trace) and engine != "ideal")


