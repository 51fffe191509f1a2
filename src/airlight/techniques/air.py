"""Techniques that see the air: single, lpv-march, lpv-sum, lpv-scatter (Billeter2012, Fig. 5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.direct import Direct, SurfaceSettings
from ..lighting.view import View
from ..lpv.lpv import Lpv, LpvSettings
from ..march.far_air import FarAir, FarSource
from ..march.march import LatticeSource, Source
from ..maths.lattice6 import LOOKUP_SCALE
from ..scatter.map_blockers import MapBlockers
from ..scatter.settings import ScatterSettings
from ..scatter.solver import ScatterSolver
from ..scene.medium import medium_box
from ..scene.scene import Scene
from ..scene.settings import setting
from ..scene.volume import Volume
from ..shafts.air_light import AirLight, AirSettings
from ..shafts.sky_air import SkyAir
from ..surface.geometry import GpuScene


@dataclass(frozen=True)
class SingleSettings(SurfaceSettings, AirSettings):
    """Surfaces, and how air is drawn."""


@dataclass(frozen=True)
class LpvMarchSettings(LpvSettings, AirSettings):
    """Light propagation volumes, and how air is drawn."""


@dataclass(frozen=True)
class LpvScatterSettings(SurfaceSettings, ScatterSettings, AirSettings):
    """Multiple scattering on a lattice, and how air is drawn."""

    occlusion: bool = setting(True, "whether surfaces stop and reflect propagating light")
    blockers: str = setting(
        "surfels", "what is known of surfaces that stop light: samples of all of them, or what six "
        "maps around the scene see, as in the paper", choices=("surfels", "maps"))  # fmt: skip
    blocker_resolution: int = setting(
        256, "side of those maps", unit="px", low=8, high=4096)  # fmt: skip


class InAir(Direct):
    """Mixed into a technique for surfaces, draws them through air with the light it scatters."""

    is_in_air = True
    has_single = True
    source_count = 0
    has_lattice = False
    scatters_on = False  # whether the lattice holds light scattered in air
    volumes_in_lattice = False  # whether light that bounced was carried through solved volumes

    def __init__(
        self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: SurfaceSettings,
        size: tuple[int, int],
    ) -> None:  # fmt: skip
        super().__init__(gpu, scene, meshes, settings, size)
        air = _air_settings(settings, has_single=self.has_single)
        has_sky = bool(self.sky.lights and self.sky.maps.layers)
        self.air_light = AirLight(
            gpu, scene, size, self.lights, air, sources=self.source_count,
            has_lattice=self.has_lattice, has_sky=has_sky, solved=self.solved(scene),
        )  # fmt: skip
        self.air = self.air_light.air
        self.sky_air: SkyAir | None = None
        if has_sky and self.air.count:
            self.sky_air = SkyAir(
                gpu,
                scene,
                self.sky,
                self.placement,
                self.texture_size,
                solved=self.solved(scene),
            )
        # Versions of what shafts and the sky's air were made with.
        self._shadows, self._sky_seen = (-1, -1), (-1, -1)
        is_endless = scene.medium is not None and scene.medium.endless
        self.far = FarAir(gpu) if is_endless else None
        self._far: FarSource | None = None

    def solved(self, scene: Scene) -> tuple[Volume, ...]:
        """Volumes whose single scattering comes with their source."""
        return ()

    def sources(self) -> list[Source]:
        """Emission textures to march."""
        return []

    def lattice_source(self) -> LatticeSource | None:
        """The lattice to march."""
        return None

    def bounced_source(self) -> LatticeSource | None:
        """The lattice that solved volumes take reflected light from."""
        return self.lattice_source()

    def solve(self, commands: Commands, scene: Scene) -> None:
        """The surfaces' part, then the air."""
        super().solve(commands, scene)
        versions = (self.lights.parallel.version, self.lights.local.version)
        self.air_light.solve(
            commands, scene, *self._bounds(scene), shadows_changed=versions != self._shadows
        )
        self._shadows = versions
        self._take_far(scene)
        if self.sky_air:
            seen = (self.meshes.version, self.blockers.version)
            is_moved, self._sky_seen = seen != self._sky_seen, seen
            with commands.stage("sky"):
                self.sky_air.encode(commands, scene, *self._bounds(scene), self.blockers.walls,
                                    self.placements, shadows_changed=is_moved)  # fmt: skip

    def _take_far(self, scene: Scene) -> None:
        if self.far and scene.medium:
            box = medium_box(scene.medium, *self._bounds(scene), scene.camera.position)
            self._far = self.far.update(
                scene.medium, float(box[1][1]), scene.lights, self.sky.lights,
                is_lattice=self.scatters_on,
            )  # fmt: skip

    def draw(self, commands: Commands, view: View) -> None:
        """Surfaces, shafts, marching, and all of it together."""
        super().draw(commands, view)
        sky = None
        if self.sky_air and self.air_light.has_sky:
            sky = self.sky_air.source(self.blockers.bound, self.placements[:-1])
        self.air_light.encode(
            commands, view, self.lights, self.sources(), self.lattice_source(), sky,
            far=self._far, frame=view.sample, is_composed=True,
        )  # fmt: skip
        self.air_light.compose(commands, view)

    @property
    def sky_cube(self) -> Texture:
        """The environment's light on surfaces, through the air."""
        return self.sky_air.cube if self.sky_air else self.sky.skylight.cube

    @property
    def sky_version(self) -> int:
        """Of what `sky_cube` holds."""
        return self.sky_air.version if self.sky_air else self.sky.skylight.version

    def pictures(self, view: View) -> dict[str, Texture]:
        """Surfaces through the air, the light the air scatters, and what it lets through."""
        direct, indirect = self.air_light.surfaces(view)
        return {
            "direct": direct,
            "indirect": indirect,
            "single_scatter": self.air_light.single_scatter,
            "multiple_scatter": self.air_light.multiple_scatter,
            "transmittance": self.air_light.transmittance,
        }

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with pictures of `size`, pixels."""
        self.air_light.resize(size)

    def release(self) -> None:
        """Give the memory back."""
        super().release()
        self.air_light.release()
        for part in (self.sky_air, self.far):
            if part:
                part.release()


class Single(InAir):
    """The technique `single`."""

    Settings = SingleSettings


class LpvMarch(InAir, Lpv):
    """The technique `lpv-march`: the lattice of bounced light seen in the air, nothing more."""

    Settings = LpvMarchSettings
    has_single = False
    has_lattice = True

    def lattice_source(self) -> LatticeSource | None:
        """In-scattered radiance from the lattice's fluence."""
        return bounced_light(self)


class LpvSum(LpvMarch):
    """The technique `lpv-sum`: lpv-march plus single scattering, the trivial combination."""

    has_single = True


class LpvScatter(InAir, Direct):
    """The technique `lpv-scatter`: light scattered many times, in air and onto surfaces."""

    Settings = LpvScatterSettings
    has_lattice = scatters_on = True

    def __init__(
        self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: LpvScatterSettings,
        size: tuple[int, int],
    ) -> None:  # fmt: skip
        super().__init__(gpu, scene, meshes, settings, size)
        self.is_bounced = True
        if settings.blockers == "maps":
            self.blockers.release()
            self.blockers = MapBlockers(
                gpu, scene, meshes, self.placement, settings.surfels,
                resolution=settings.blocker_resolution,
            )  # fmt: skip
        self.solver = ScatterSolver(
            gpu, self.lattice_scene(scene), meshes, self.placement, settings, self.lights,
            self.sky, self.blockers,
        )  # fmt: skip

    def lattice_scene(self, scene: Scene) -> Scene:
        """The scene as the lattice sees it."""
        return scene

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Surfaces and air, then the lattice."""
        super().solve(commands, scene)
        self.solver.encode(commands, self.lattice_scene(scene), *self._bounds(scene))

    def lattice_source(self) -> LatticeSource | None:
        """The accumulated track of light."""
        return self.solver.marched()

    @property
    def lattice_bound(self) -> dict[str, Any]:
        """The accumulated states, for surfaces."""
        surfaces = self.solver.surfaces
        return {"lattices": self.table.filled([surfaces.params()]), **surfaces.bound}

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        return dict(self.solver.stats)

    def release(self) -> None:
        """Give the memory back."""
        super().release()
        self.solver.release()


def bounced_light(technique: Lpv) -> LatticeSource:
    """Mean radiance of a lattice of bounced light."""
    scale = LOOKUP_SCALE / (technique.placement.cell**2 * technique.power_scale)
    bound = {**technique.textures.bound, **technique.blockers.bound}
    finer = tuple(part.placement for part in technique.cascades[:-1])
    return LatticeSource(technique.placement, bound, scale, finer=finer)


def _air_settings(settings: Any, *, has_single: bool) -> AirSettings:
    """The air's part of a technique's settings."""
    names = AirSettings.__dataclass_fields__
    values = {name: getattr(settings, name) for name in names}
    return AirSettings(**(values if has_single else {**values, "shafts": "off"}))
