# SPDX-License-Identifier: Apache-2.0
"""Scenes."""

from __future__ import annotations

import dataclasses
import os
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

from ._core import InputError, SceneHandle, texel_formats

#: The columns of a vertex and their defaults: [pixel], [unit of s], [texel], 0 to 1.
VERTEX = {"x": 0.0, "y": 0.0, "s": 1.0, "u": 0.0, "v": 0.0, "r": 1.0, "g": 1.0, "b": 1.0, "a": 1.0, "fog": -1.0,
          "project_x": 0.0, "project_y": 0.0, "project_w": 0.0, "z": -1.0, "u2": 0.0, "v2": 0.0, "nx": 0.0, "ny": 0.0,
          "nz": 0.0, "lx": 0.0, "ly": 0.0, "lz": 0.0}


def _vertices(vertices: Any) -> NDArray[np.float64]:
    try:
        given = np.asarray(vertices, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"vertices: {error}; expected numbers") from None
    if given.ndim != 3 or given.shape[1] != 3 or not 3 <= given.shape[2] <= len(VERTEX):
        raise InputError(f"vertices: the shape is {given.shape}; expected (n, 3, k), k from 3 (x, y, s) to "
                         f"{len(VERTEX)} ({', '.join(VERTEX)})")
    out = np.empty((given.shape[0], 3, len(VERTEX)))
    out[...] = list(VERTEX.values())
    out[..., : given.shape[2]] = given
    return out


def _codes(what: str, color: Any) -> list[int]:
    given = np.asarray(color)
    if given.shape != (3,) or given.dtype.kind not in "iu" or given.min() < 0 or given.max() > 255:
        raise InputError(f"{what}: {color!r} is no colour; expected three integers of 0 to 255")
    return [int(c) for c in given]


@dataclasses.dataclass(frozen=True)
class Texels:
    """A texture of a texel format of the specification, other than rgba8888, as it lies in memory.

    format         "rgb565", "dxt1" ...
    raw            its bytes, blocks row by row from the top left
    width, height  [texel]
    table          p8, ap88: 256 times red, green, blue, alpha; yiq422, ayiq8422: 16 of Y, 12 of I, 12 of Q
    """

    format: str
    raw: bytes
    width: int
    height: int
    table: Sequence[int] = ()


@dataclasses.dataclass(frozen=True)
class Light:
    """A light in the viewer's space: x to the right, y downward, z along the view axis.

    direction  to a light that is far away, of any length; or None
    position   of a light that stands there [unit of s]; or None
    ambient    share of what reaches every surface, 0 to 1
    specular   share of the highlight, 0 to 1 with ambient
    exponent   of the highlight, 1 to 200
    lunar      k of the lunar law, 0 to 16, where light.law is lunar
    reach      where light.fall is first or second: all but the ambient share is divided by (d / reach)^a + offset [unit of s];
               0: brightness does not fall
    offset     0 to 64
    """

    direction: Sequence[float] | None = None
    position: Sequence[float] | None = None
    ambient: float = 0.2
    specular: float = 0.0
    exponent: int = 32
    lunar: float = 0.0
    reach: float = 0.0
    offset: float = 0.0

    def _given(self) -> tuple[int, list[float], list[float], int]:
        if (self.direction is None) == (self.position is None):
            raise InputError("light: has both or neither of direction and position; expected one of them")
        try:
            place = [float(part) for part in (self.direction if self.position is None else self.position) or ()]
            numbers = [float(n) for n in (self.ambient, self.specular, self.lunar, self.reach, self.offset)]
        except (TypeError, ValueError) as error:
            raise InputError(f"light: {error}; expected numbers") from None
        if len(place) != 3:
            raise InputError(f"light: has {len(place)} coordinates; expected three")
        return 1 if self.position is None else 2, place, numbers, _integer("light.exponent", self.exponent)

    def _json(self) -> dict[str, Any]:
        _, place, numbers, exponent = self._given()
        return {"direction" if self.position is None else "position": place, "exponent": exponent,
                **dict(zip(("ambient", "specular", "lunar", "reach", "offset"), numbers))}


def _texture(i: int, texture: Any) -> Any:
    if isinstance(texture, Texels):
        if texture.format not in texel_formats[1:]:
            raise InputError(f"textures[{i}].format: {texture.format!r}; expected one of {', '.join(texel_formats[1:])}")
        try:
            table = np.asarray(texture.table, dtype=np.int16).ravel().tolist()
            raw = bytes(memoryview(texture.raw))
        except (TypeError, ValueError, OverflowError) as error:
            raise InputError(f"textures[{i}]: {error}; expected bytes, and a table of integers") from None
        return (texel_formats.index(texture.format), _integer("width", texture.width), _integer("height", texture.height), raw, table)
    given = np.asarray(texture)
    if given.ndim != 3 or given.shape[2] not in (3, 4) or given.dtype != np.uint8:
        raise InputError(f"textures[{i}]: the shape is {given.shape} of {given.dtype}; expected (height, width, 3 or 4) of uint8")
    out = np.full((*given.shape[:2], 4), 255, np.uint8)
    out[..., : given.shape[2]] = given
    return out


def _integer(what: str, value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not -(2**31) <= value < 2**31:
        raise InputError(f"{what}: {value!r}; expected an integer")
    return int(value)


def _shadow(light: Any, size: Any, bias: Any, dark: Any) -> tuple[Any, ...]:
    """The light as the library takes it."""
    try:
        numbers = [float(n) for n in light]
        kept = (-1.0 if bias is None else float(bias), float(dark))
    except (TypeError, ValueError) as error:
        raise InputError(f"shadow, shadow_bias, shadow_dark: {error}; expected numbers") from None
    if len(numbers) not in (3, 7):
        raise InputError(f"shadow: {light!r}; expected a light (x, y, z), or (x, y, z, X, Y, Z, degrees)")
    at, degrees = (None, 0.0) if len(numbers) == 3 else (numbers[3:6], numbers[6])
    return (numbers[:3], at, degrees, _integer("shadow_map", size), *kept)


class Scene:
    """Triangles on the screen in the order of drawing, their textures, and the size of the picture.

    `source` is "demo", a stream (.tri, .trib) or a mesh (OBJ, PLY, glTF ...), which a camera around it shows. With "@3"
    behind the name it is what camera 3 sees. `width` and `height` are of the picture [pixel]; 0: the stream's own, or
    640 x 480. `frame` is the image that a stream's dynamic textures show at first, from 0. A scene never changes.

    `shadow` is a light (x, y, z) that casts shadows, or (x, y, z, X, Y, Z, degrees): the point that it looks at and the angle
    that it sees. Of a mesh and of "demo" it stands in their world, else as the viewer sees: x to the right, y downward, z
    along the view axis. `shadow_map` is the size of its depth buffer [texel]; a lit surface may rise towards the light by
    `shadow_bias` texels per texel, and by None as its slope asks for, with codes of 16 bits; `shadow_dark` is what is left of
    a colour in the shadow, 0 to 1. It needs a configuration with project.unit = "reciprocal".
    """

    __slots__ = ("_handle", "__weakref__")

    def __init__(self, source: str | os.PathLike[str] = "demo", width: int = 0, height: int = 0, frame: int | None = None, *,
                 shadow: Sequence[float] | None = None, shadow_map: int = 1024, shadow_bias: float | None = None, shadow_dark: float = 0.35):
        if not isinstance(source, (str, os.PathLike)):
            raise InputError(f"bitspan.Scene: {source!r} is no scene; expected a name or a path, or Scene.from_vertices")
        self._handle = SceneHandle.load(os.fspath(source), _integer("width", width), _integer("height", height),
                                        None if frame is None else _integer("frame", frame),
                                        None if shadow is None else _shadow(shadow, shadow_map, shadow_bias, shadow_dark))

    @classmethod
    def from_vertices(cls, vertices: Any, width: int = 640, height: int = 480, *, texture: Any = -1, textures: Sequence[Any] = (),
                      s_range: tuple[float, float] = (1.0, 1000.0), focal: float = 500.0,
                      background: Sequence[int] = (0, 0, 0), fog: tuple[Sequence[int], float] | None = None,
                      projector: tuple[float, float] | None = None, light: Light | None = None, name: str = "scene") -> Scene:
        """Makes a scene of arrays.

        vertices    (n, 3, k): per corner x, y [pixel, origin top left, pixel centres at .5], s [distance along the view axis],
                    u, v [texel], r, g, b, a [0 to 1], fog [factor of fog.mode = vertex, 0 to 1; -1: it follows from s];
                    project_x, project_y, project_w [W is the distance along the projector's axis, X / W and Y / W are column
                    and row of its texture]; z [depth of depth.line = z, 0 nearest to 1; -1: it follows from s]; u2, v2 [texel,
                    of the second unit with texture.second = own]; nx, ny, nz [outward normal in the viewer's space, of any
                    length up to 2]; lx, ly, lz [texel, column, row and height of the light in the field of a map of
                    normals]; k from 3 to 22, the columns left out are 0, 0, 1, 1, 1, 1, -1, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0, 0, 0
        texture     the index into `textures` per triangle, or one for all; -1: none
        textures    (height, width, 3 or 4) arrays of uint8, or Texels
        s_range     the range of s that the formats are scaled for
        focal       the focal length [pixel]
        background  red, green, blue, 0 to 255
        fog         (colour, distance [unit of s]); None: no fog
        projector   (s_min, s_max), the range of the distances from it [unit of s]; None: no projector
        light       a Light; None: none
        """
        corners = _vertices(vertices)
        try:
            texture_of = np.array(np.broadcast_to(np.asarray(texture), len(corners)))
        except ValueError:
            raise InputError(f"texture: has {len(texture)} entries; expected one per triangle, {len(corners)}") from None
        if texture_of.dtype.kind not in "iu" or np.any(abs(texture_of.astype(np.int64)) >= 2**31):
            raise InputError(f"texture: {texture!r}; expected integers")
        try:
            low, high = map(float, s_range)
            haze = None if fog is None else (_codes("fog", fog[0]), float(fog[1]))
            length = float(focal)
            thrown = None if projector is None else (float(projector[0]), float(projector[1]))
        except (TypeError, ValueError, IndexError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(f"s_range, focal, fog, projector: {error}; expected (low, high), a number, (colour, distance), "
                             "(s_min, s_max)") from None
        out = object.__new__(cls)
        out._handle = SceneHandle.make(corners, texture_of.astype(np.int32), [_texture(i, t) for i, t in enumerate(textures)],
                                       _integer("width", width), _integer("height", height), (low, high), length,
                                       _codes("background", background), haze, thrown,
                                       None if light is None else light._given(), str(name))
        return out

    @property
    def name(self) -> str:
        return self._handle.name

    @property
    def width(self) -> int:
        """Of the picture [pixel]."""
        return self._handle.width

    @property
    def height(self) -> int:
        """Of the picture [pixel]."""
        return self._handle.height

    @property
    def s_range(self) -> tuple[float, float]:
        return self._handle.s_range

    @property
    def notes(self) -> list[str]:
        """What of a mesh file the scene does not show, such as points and lines."""
        return self._handle.notes.splitlines()

    @property
    def vertices(self) -> NDArray[np.float64]:
        """(n, 3, 19) float64: the columns of VERTEX per corner; a view of the scene's memory."""
        return self._handle.vertices

    @property
    def texture_of(self) -> NDArray[np.int32]:
        """(n,) int32: the index of each triangle's texture, -1 for none; a view."""
        return self._handle.texture_of

    def __len__(self) -> int:
        return len(self.texture_of)

    def __repr__(self) -> str:
        return f"<bitspan.Scene {self.name}: {len(self)} triangles, {self.width} x {self.height} pixels>"


def scene_of(scene: Scene | str | os.PathLike[str], width: int = 0, height: int = 0) -> Scene:
    """Returns the scene, or the one that a name or path stands for."""
    if not isinstance(scene, Scene):
        return Scene(scene, width, height)
    if (width or height) and (width, height) != (scene.width, scene.height):
        raise InputError(f"width, height: {scene!r} has a size already; expected none")
    return scene
