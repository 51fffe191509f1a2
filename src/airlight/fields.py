"""The contract between solvers: what each is given, and the fields that it yields.

    frame    the scene of this frame, and the box that shadow maps must cover
    solver   solve(commands, frame, fields) -> fields       independent of any view
             solve_view(commands, view, fields) -> fields   what depends on the eye
    fields   irradiance, gathered -> lighting of surfaces
             scattered, volumes, sky_scatter, half_space -> marching of media
             reflected -> media that are lit by surfaces
             air, forward, lit -> rays of the gather

Solvers run in the order of the recipe and are given the fields of those before them. The reader of
a field does not know which solver it comes from.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np

from .gpu.commands import Commands
from .gpu.memory import Buffer, Texture
from .gpu.rows import Table
from .lattice.irradiance import Irradiance, SkyIrradiance
from .lattice.placement import Fade, Placement
from .lighting.gathered import Gathered
from .lighting.view import View
from .maths.transforms import F64
from .scene.scene import Scene
from .surface.reflective import ReflectiveShadowMaps

# Values of `Source.medium` that are no row of the media.
ABSOLUTE, ALL_MEDIA, SOME_MEDIA = -1, -2, -3
FORWARD_REACH = 3
"""Cells to each side over which forward light is averaged."""
_FORWARD_BLUR_CELLS = 2.0  # deviation of a mean over so many cells to each side


@dataclass(frozen=True, eq=False)
class Source:
    """Emission on a grid: rgb of an rgba16float (or wider, filterable) 3D texture.

    With `medium` ABSOLUTE, texel * `scale` is J in W m^-3 sr^-1. Otherwise it is mean radiance,
    W m^-2 sr^-1 (fluence/4pi), and is multiplied by the scattering coefficient, at the density's
    own resolution, of ALL_MEDIA, of SOME_MEDIA, whose rows are `members`, or of one (its row: the
    scene's medium first, then the volumes) and the next `parts` - 1, which are one volume's.
    `whole`: the same with what shafts draw in the eye's rays; `texture` if not given. `mean`: what
    rays of a gather meet instead, of the reduced medium (similarity theory), through which they go
    then. `texels`: of the texture along a solved cell. `fade`, in shares of its box: where it is a
    finer grid inside the next source, which takes over there.
    """

    texture: Texture
    uvw_from_world: F64
    scale: float = 1.0
    medium: int = ABSOLUTE
    parts: int = 1
    members: tuple[int, ...] = ()
    whole: Texture | None = None
    mean: Texture | None = None
    fade: Fade | None = None
    texels: int = 1

    @property
    def cell_m(self) -> float:
        """The shortest side of its cells, metres."""
        # Lengths of the grid's edges in the world.
        lengths = np.linalg.norm(np.linalg.inv(self.uvw_from_world)[:3, :3], axis=0)
        return self.texels * float((lengths / np.array(self.texture.size)).min())


@dataclass(frozen=True, eq=False)
class InScattered:
    """For which eye a lattice has what media scatter towards it, and where their light goes.

    From the middle of a cell the eye counts as a cell farther back than it is, against `ahead`
    (3,), unit length. `along`: xyz and luminance, as `AirLobes.scattered_along`.
    """

    along: Texture
    ahead: F64


@dataclass(frozen=True, eq=False)
class LatticeSource:
    """Solved lattices of states (a, b): radiance `scale` * (a + `direct` g b.w) per sigma_s.

    `bound`: lattice_red/green/blue (or sky_red/green/blue), and the blockers' textures
    lattice_visibility_a/b and lattice_walls. For states whose lookup is Kaplanyan2010's,
    scale = (2/3)/(s^2 power_scale) and direct = 1; for accumulated track length V,
    scale = 1/(4 pi s^3 power_scale) and direct = 3. `finer`: lattices inside this one that share
    its textures, the finest first. Steps are as long as the cells of the finest lattice that
    covers the sample (Kaplanyan2010 section 7). `third`: the five coefficients of a third band
    (wgsl/third_band.wgsl). `forward`: light that was only scattered forwards and is still near
    its beam. `mean`: the constant terms a of the three channels as rgb, for isotropic media: one
    load instead of three. `is_reduced_medium`: the light is that of the reduced medium
    (similarity theory), through which it is marched. `inscattered`: `mean` is what media scatter
    towards the eye, per sigma_s, as their phase functions have it, and is all that there is of a.
    """

    placement: Placement
    bound: dict[str, Any]
    scale: float
    direct: float = 1.0
    finer: tuple[Placement, ...] = ()
    forward: ForwardSource | None = None
    mean: Texture | None = None
    third: Texture | None = None
    is_reduced_medium: bool = False
    inscattered: InScattered | None = None

    @property
    def levels(self) -> tuple[Placement, ...]:
        """All its lattices, the finest first."""
        return (*self.finer, self.placement)

    @property
    def cell_m(self) -> float:
        """The side of its smallest cells, metres."""
        return self.levels[0].cell


@dataclass(frozen=True, eq=False)
class ForwardSource:
    """Light that was only scattered forwards, per light: rgb * `scale` in W m^-2.

    Its alpha is the optical depth of scattering; `slabs` lights lie one behind the other along z.
    `blurred`: the same, averaged over FORWARD_REACH cells to each side, of side `cell_m`, metres,
    in the largest lattice, as far as no wall stands between. `table`: the lights' rows of
    LightData, of which the first `count` are in use.
    """

    texture: Texture
    blurred: Texture
    table: Table
    count: int
    slabs: int
    scale: float
    cell_m: float

    @property
    def spread(self) -> float:
        """In m^-2: `spread` (1 - g) distance^2 nears 1 where a beam is as wide as that."""
        # A beam spreads by .29 sqrt(2 (1 - g)) of its path (`scatter.forward`).
        return 2.0 * (0.29 / (_FORWARD_BLUR_CELLS * self.cell_m)) ** 2


@dataclass(frozen=True, eq=False)
class HalfSpaceLight:
    """Light of an endless medium, solved analytically as a half-space (`media.half_space`).

    `table`, W m^-2 sr^-1, has a row for each optical depth: the mean radiance of the reduced
    medium, that of the sky, and the sky's radiance scattered once towards `side`^2 directions.
    `top`, m: the height of the surface of the medium; `sigma_t`, m^-1: of its densest channel.
    """

    table: Buffer
    side: int
    top: float
    sigma_t: float


@dataclass(frozen=True, eq=False)
class Frame:
    """One frame of a scene. `low`, `high` (3,), metres: the box that shadow maps must cover.

    `is_still`: its image is one of several samples, and may take its time.
    """

    scene: Scene
    low: F64
    high: F64
    is_still: bool = False

    @property
    def bounds(self) -> tuple[F64, F64]:
        """The lower and the upper corner of the box."""
        return self.low, self.high


@dataclass(frozen=True, eq=False)
class ReflectedLight:
    """Light that surfaces reflect, as media read it from lattices.

    `version`: equal as long as the light is the same. `knows_media`: the lattices were solved with
    the scene's volumes in them, so the light is attenuated inside the volumes.
    """

    source: LatticeSource
    version: tuple[Any, ...]
    knows_media: bool = False


@dataclass(frozen=True, eq=False)
class AirLobes:
    """Where the light of an `AirLight` goes, in the units of its `mean`'s texture.

    `straight`: mean radiance of unscattered light, as the media themselves attenuate it. `along`,
    `scattered_along`: of that light's luminance, and of the rest's, the mean over all directions
    times these, x y z of the world; a of the second is the luminance.
    """

    straight: Texture
    along: Texture
    scattered_along: Texture


@dataclass(frozen=True, eq=False)
class AirLight:
    """What the rays of a gather meet in media.

    `mean`: the mean radiance of all light, unscattered too; reduced media (similarity theory)
    scatter their share of it into rays from surfaces. `lobes`: what the media themselves scatter
    into rays of their cells.
    """

    mean: LatticeSource
    lobes: AirLobes


@dataclass(frozen=True, eq=False)
class Fields:
    """The fields that solvers have yielded so far.

    sky          direct irradiance of the environment on surfaces, W m^-2
    irradiance   indirect irradiance of lattices on surfaces, W m^-2
    gathered     irradiance of a view's pixels, W m^-2, which lighting takes in place of both
    reflected    light that surfaces reflect into media
    air          light in media for the rays of a gather
    lit          maps of the lights, whose texels are what these shine on
    forward      irradiance of surfaces, W m^-2, by light that media have only scattered forwards;
                 a part of `irradiance`, which no ray of a gather meets
    scattered    mean radiance on lattices, W m^-2 sr^-1; media scatter their share of it
    sky_scatter  the same, of the environment's direct light
    volumes      radiance that volumes scatter towards the eye, on grids of their own
    half_space   light of an endless medium beyond the lattices
    """

    sky: SkyIrradiance
    irradiance: Irradiance | None = None
    gathered: Gathered | None = None
    reflected: ReflectedLight | None = None
    air: AirLight | None = None
    lit: tuple[ReflectiveShadowMaps, ...] = ()
    forward: Irradiance | None = None
    scattered: LatticeSource | None = None
    sky_scatter: LatticeSource | None = None
    volumes: tuple[Source, ...] = ()
    half_space: HalfSpaceLight | None = None


class Solver(Protocol):
    """One part of a technique's light transport; made once, used for any number of frames.

    `may_lag`: it takes long, and while a hand moves a light its fields of an earlier frame will do.
    """

    may_lag: ClassVar[bool] = False

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """`fields` with those that this solver adds; nothing in them depends on a view."""

    def solve_view(self, commands: Commands, view: View, fields: Fields) -> Fields:
        """`fields` with those that depend on the eye of `view`; as they are where none do."""
        return fields

    def jitters(self, samples: int) -> int:
        """How many images of each of a still's `samples`, each with a sub-pixel jitter of its own,
        had best share what it finds for the eye."""
        return 1

    @property
    def stats(self) -> dict[str, Any]:
        """This solver's part of --stats."""
        return {}

    def release(self) -> None:
        """Called when the technique goes, before the kit's `gpu` gives back what was made with it.

        For what a solver holds beside that; a class that derives from this one need not have it.
        """
        return
