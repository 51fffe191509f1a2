"""Scattered light that comes into the lattice from an endless medium around it (media.half_space).

Without it an open scene would be darker than the medium beyond it. Only what was scattered already:
directional lights and the sky are injected into every cell separately. Hops would soon deflect
light that comes in flat out of a thin layer of fog, so it is traced straight to the cells and
propagates from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3u
from ..gpu.memory import Buffer, buffer_of
from ..gpu.slots import storage, uniform
from ..lattice.blockers import BLOCKER_SLOTS, Blockers
from ..lattice.placement import LatticeParams, Placement
from ..maths.half_space import plane_light, plane_radiance
from ..maths.lattice26_walls import returned_sharpness
from ..maths.transforms import F64
from ..media.gpu_media import GpuMedia
from ..media.march.half_space import directional
from ..scene.lights import Light
from ..scene.medium import Medium

TURNS = 6
"""Directions around the vertical, on each of LEVELS levels."""
LEVELS = 8
ROWS = 48
_LAST = 0.975  # of depth/(1 + depth), in which rows are equally spaced


class BorderParams(Struct):
    """The medium around the lattice."""

    top = f32("m, where it begins")
    sigma = f32("m^-1, of its densest channel")
    has_walls = f32("1: surfaces reflect")
    is_nested = u32("1: the lattice is a finer one within the largest")


class AddParams(Struct):
    """The lattice's size, thrice."""

    count = vec3u("cells; of three channels along z")


class _Beams(ComputePass):
    workgroup = (32, 4, 1)
    file = "border_beams.wgsl"

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self.slots = (
            uniform("params", BorderParams),
            uniform("lattice", LatticeParams),
            uniform("outer", LatticeParams),
            *BLOCKER_SLOTS,
            *media.medium_slots,
            storage("reflectance", "u32"),
            storage("directions", "vec2f"),
            storage("radiance", "vec4f"),
            storage("border", "vec4f", "read_write"),
        )
        super().__init__(gpu, generated=media.medium_wgsl + _CONSTANTS)


class _AddBorder(ComputePass):
    slots = (
        uniform("params", AddParams),
        storage("border", "vec4f"),
        storage("base", "vec4f"),
        storage("cells", "vec4f", "read_write"),
        storage("beams", "vec4f", "read_write"),
        storage("surface_beams", "vec4f", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "inject_border.wgsl"


@dataclass(frozen=True)
class Outside:
    """The isotropic `medium` around a lattice, endless below the height `top`, m, and `lights`."""

    medium: Medium
    top: float
    lights: tuple[Light, ...]


class InjectBorder:
    """What comes in, W, into `cells`; its track on the straight path to them, W m, in `beams`, and
    in `surface_beams` such that two bands of it bring walls what they get.
    """

    def __init__(self, gpu: Gpu, placement: Placement, media: GpuMedia) -> None:
        self._find, self._add = _Beams(gpu, media), _AddBorder(gpu)
        self._media, self._count = media, placement.count
        # Power, the track of marching and that of surfaces, one behind the other.
        cells = 3 * placement.cells
        self._border = Buffer(gpu, "light from the border", 3 * cells * 16)
        self.beams = Buffer(gpu, "beams from the border", cells * 16)
        self.surface_beams = Buffer(gpu, "beams to surfaces", cells * 16)
        self._radiance = Buffer(gpu, "light of an endless medium", LEVELS * ROWS * 16)
        self._directions = buffer_of(
            gpu, "directions into the lattice", levels().astype(np.float32)
        )
        self._outside: Outside | None = None

    def find(
        self,
        commands: Commands,
        outside: Outside,
        places: tuple[Placement, Placement],
        blockers: Blockers,
        reflectance: Buffer | None,
        *,
        is_new: bool,
    ) -> None:
        """Trace the light of `outside` to all cells, where it changed.

        `places`: of the cells, and of the largest lattice, beyond which the light begins. `is_new`:
        walls or media are others than before, or the lattice has moved. Without `reflectance`
        walls are black.
        """
        # Light from outside stays until medium, lights or walls are others, or the lattice moves.
        if outside == self._outside and not is_new:
            return
        self._outside = outside
        # What comes in at each depth below the top, solved on the host.
        self._radiance.write(incoming_light(outside.medium, outside.lights).astype(np.float32))
        # How much of it reaches each cell on straight paths, and what walls turn back there.
        placement, largest = places
        params = BorderParams(
            top=outside.top,
            sigma=max(outside.medium.sigma_t),
            has_walls=float(reflectance is not None),
            is_nested=int(placement.cell < largest.cell),
        )
        bound: dict[str, Any] = {**blockers.bound, **self._media.medium_bound}
        self._find.dispatch(
            commands,
            placement.count,
            params=params,
            lattice=placement.params(),
            outer=largest.params(),
            reflectance=reflectance or self._radiance,
            directions=self._directions,
            radiance=self._radiance,
            border=self._border,
            **bound,
        )

    def encode(self, commands: Commands, cells: Buffer, base: Buffer) -> None:
        """cells += what `find` found, and beams = `base` + its track."""
        # Channels lie one after the other along z, of power and of both tracks alike.
        x, y, z = self._count
        self._add.dispatch(
            commands,
            (x, y, 3 * z),
            params=AddParams(count=(x, y, 3 * z)),
            border=self._border,
            base=base,
            cells=cells,
            beams=self.beams,
            surface_beams=self.surface_beams,
        )


def levels() -> F64:
    """(LEVELS, 2): cosines to the vertical, dense where rays are flat, and solid angles, sr."""
    # Gauss-Legendre nodes in the square root of the cosine: most of them look nearly flat.
    nodes, weights = np.polynomial.legendre.leggauss(LEVELS // 2)
    s, solid = 0.5 * (nodes + 1.0), 2.0 * np.pi / TURNS * 0.5 * weights
    up = np.column_stack([s**2, 2.0 * s * solid])
    return np.concatenate([up * (-1.0, 1.0), up])


def incoming_light(medium: Medium, lights: Sequence[Light]) -> F64:
    """(LEVELS * ROWS, 4), W m^-2 sr^-1: radiance seen on each level at each row's depth."""
    # Rows at equal steps of depth/(1 + depth), dense where light changes most.
    share = np.linspace(0.0, _LAST, ROWS)
    depth = share / (1.0 - share)
    table = np.zeros((LEVELS, ROWS, 4))
    # Each channel is a plane-parallel problem of its own albedo, in optical depths.
    for c in range(3):
        directions, irradiances = directional(lights, c)
        light = plane_light(medium.albedo[c], -directions[:, 1], irradiances)
        # Rows are depths of the densest channel, for which the others are thinner.
        own = depth * medium.sigma_t[c] / max(medium.sigma_t)
        table[..., c] = plane_radiance(light, own, levels()[:, 0]).T
    return table.reshape(-1, 4)


_CONSTANTS = (
    f"const LEVELS = {LEVELS}u;\nconst TURNS = {TURNS}u;\nconst ROWS = {ROWS}u;\n"
    f"const LAST = {_LAST:.9e};\nconst SHARPNESS = {returned_sharpness():.9e};\n"
)
