"""Participating media in a frame: how they attenuate lights, and all light that they scatter.

solve   media on the device -> the light of the sky through them, the half space of an endless
one draw    shafts of lights -> marching of every solved field -> surfaces behind them
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from ..fields import Fields, Frame, HalfSpaceLight, Solver
from ..gpu.commands import Commands
from ..gpu.memory import Texture
from ..lattice.irradiance import SkyIrradiance
from ..lighting.kit import Kit
from ..lighting.view import View
from ..scene.medium import Medium, medium_box
from ..scene.volume import Volume
from .density_grids import sky_columns
from .gpu_media import GpuMedia
from .image_textures import Expected
from .march.half_space import HalfSpace
from .march.marched_light import MarchedLight
from .media_image import MediaImage
from .settings import MediaSettings
from .sky_in_media import SkyInMedia


class Solved(NamedTuple):
    """Media that are solved on grids of their own; those bring single scattering.

    `has_local_shafts`: but for that of local lights, which shafts draw.
    """

    media: Sequence[Medium | Volume] = ()
    has_local_shafts: bool = False


NOT_SOLVED = Solved()


class Media(Solver):
    """A solver whose fields are the light of the sky through media; it also draws the media."""

    def __init__(
        self,
        kit: Kit,
        settings: MediaSettings,
        *,
        sources: int = 0,
        is_lattice_marched: bool = False,
        has_multiple: bool = False,
        has_sky: bool = True,
        solved: Solved = NOT_SOLVED,
    ) -> None:
        """For fields of so many `sources` volumes, and of lattices if `is_lattice_marched`.

        `has_multiple`: lattices hold multiple scattering. `has_sky`: single scattering of the sky
        is drawn here. `solved`: media whose sources include single scattering. Raises
        SettingsError, and SceneError for more media than can be drawn.
        """
        self.kit, self.has_multiple = kit, has_multiple
        scene, sky = kit.context.scene, kit.sky
        has_sky = has_sky and bool(sky.lights and sky.maps.layers)
        # What draws along eye rays, with the table of all media.
        self.image = MediaImage(
            kit.gpu,
            scene,
            kit.context.size,
            kit.lights,
            settings,
            Expected(sources, is_lattice_marched, has_sky, *solved, kit.shared),
        )
        # The environment's light, through media in the cells of the lattices.
        self.sky: SkyInMedia | None = None
        if has_sky and self.on_device.count:
            self.sky = SkyInMedia(
                kit.gpu,
                scene,
                sky,
                kit.placement,
                kit.lattices.texture_size,
                columns=sky_columns(kit.lattices.placements[0].cell, kit.shared),
                solved=solved.media,
            )
        # An endless medium goes on beyond all lattices, as a half-space.
        is_endless = scene.medium is not None and scene.medium.endless
        self._half_space = HalfSpace(kit.gpu) if is_endless else None
        # Versions of the shadow maps and blockers that shafts and the sky were computed with.
        self._shadows, self._sky_seen = (-1, -1), (-1, -1)

    @property
    def on_device(self) -> GpuMedia:
        """All media on the device, which attenuate lights."""
        return self.image.media

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """Yield the light of the sky through media, and that of an endless medium."""
        # What media do to light on its path, and the shadow maps that shafts are cut out of.
        lights = self.kit.lights
        shadows = (lights.parallel.version, lights.local.version)
        self.image.solve(
            commands, frame.scene, *frame.bounds, shadows_changed=shadows != self._shadows
        )
        self._shadows = shadows
        # Light that lattices do not hold: beyond them, and the sky's.
        fields = replace(fields, half_space=self._far(frame))
        return fields if self.sky is None else self._lit_by_sky(commands, frame, fields)

    def _lit_by_sky(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        assert self.sky is not None
        # In cells, where anything changed; surfaces and media read the same cells.
        lattices, blockers = self.kit.lattices, self.kit.blockers
        seen = (self.kit.meshes.version, blockers.version)
        is_moved, self._sky_seen = seen != self._sky_seen, seen
        with commands.stage("sky"):
            self.sky.encode(
                commands, frame, blockers.walls, lattices.placements, shadows_changed=is_moved
            )
        # Surfaces read the cube, media scatter the bands, where single scattering is drawn.
        sky = SkyIrradiance(self.sky.cube)
        if not self.image.has_sky:
            return replace(fields, sky=sky)
        source = self.sky.source(blockers.bound, lattices.placements[:-1])
        return replace(fields, sky=sky, sky_scatter=source)

    def _far(self, frame: Frame) -> HalfSpaceLight | None:
        medium = frame.scene.medium
        if self._half_space is None or medium is None:
            return None
        # The half-space begins at the top of the medium's box.
        box = medium_box(medium, *frame.bounds, frame.scene.camera.position)
        return self._half_space.update(
            medium,
            float(box[1][1]),
            frame.scene.lights,
            self.kit.sky.lights,
            is_lattice=self.has_multiple,
        )

    def draw(self, commands: Commands, view: View, fields: Fields) -> None:
        """Draw single scattering, marched fields, transmittance, and surfaces behind them."""
        self.image.encode(
            commands,
            view,
            self.kit.lights,
            MarchedLight(fields.volumes, fields.scattered, fields.sky_scatter, fields.half_space),
            frame=view.number,
            is_composed=True,
        )
        self.image.compose(commands, view)

    def layers(self, view: View) -> dict[str, Texture]:
        """The images that `draw` wrote, by layer."""
        direct, indirect = self.image.surfaces(view)
        return {
            "direct": direct,
            "indirect": indirect,
            "single_scatter": self.image.single_scatter,
            "multiple_scatter": self.image.multiple_scatter,
            "transmittance": self.image.transmittance,
        }

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with images of `size`, pixels."""
        self.image.resize(size)
