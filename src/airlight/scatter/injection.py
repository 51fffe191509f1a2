"""Light that enters a lattice, W per cell, before it propagates (Billeter2012 sections 3.1, 4.1).

the sky's maps          -> reflected, scattered once -> static, while nothing it reads changes
reflective shadow maps  -> virtual point lights, random points of rays   -> reflected
lights' shadow maps     -> scattered once, gathered by each cell         -> source
an endless medium       -> scattered before it comes in, at the border   -> source, beams
media that scatter forwards -> light deflected once, beside the lattice  -> forward
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..fields import Frame
from ..gpu.commands import Commands
from ..gpu.memory import Buffer
from ..lattice.inject import new_sums
from ..lattice.lobes import InjectionTarget
from ..lattice.placement import Placement
from ..lighting.kit import Kit
from ..media.reduced import reduced_scene
from ..media.stale_cells import SkyLights, StaleCells
from ..scene.medium import medium_box
from ..scene.scene import Scene
from .cell_lights import CellLights
from .cells import LatticeCells
from .entering_light import EnteringLight
from .forward import ForwardLight
from .inject_border import InjectBorder, Outside
from .inject_single import ROW_BYTES, CellFluence


class Injection:
    """Fills `source`, W per cell and channel, from the kit's lights and sky in `cells`."""

    def __init__(self, kit: Kit, scene: Scene, light: EnteringLight, cells: LatticeCells) -> None:
        gpu, count = kit.gpu, cells.placement.cells
        self.kit, self.light, self.cells = kit, light, cells
        # Light by light of media that scatter forwards; and an endless medium's, from outside.
        self.forward = ForwardLight(gpu, cells.placement, light.media, light.forward)
        is_endless = scene.medium is not None and scene.medium.endless
        self._border: InjectBorder | None = None
        if is_endless:
            self._border = InjectBorder(gpu, cells.placement, light.media.lights)
        # Light that changes with the sky alone is kept apart from what lights bring in each frame.
        self._sums = new_sums(gpu, cells.placement)
        self.black, self.static, self.reflected, self.source = (
            Buffer(gpu, name, 3 * count * 16)
            for name in ("no light", "static light", "reflected", "source")
        )
        self._static_key = b""
        self._sky_single = Buffer(gpu, "scattered once of the sky", 3 * count * 16)
        self._stale = StaleCells(gpu, count)
        self._sky_made: tuple[Any, ...] = ()
        self._sky_media = -1  # the version of its media
        # Unscattered light in cells: none, the sky's, and all of it.
        self._fluences: list[Buffer] = []
        if light.keeps_light:
            self._fluences = [
                Buffer(gpu, f"{name} in cells", ROW_BYTES * count)
                for name in ("none", "sky", "light")
            ]

    @property
    def placement(self) -> Placement:
        """Where the cells are now."""
        return self.cells.placement

    def encode(self, commands: Commands, frame: Frame, *, is_new: bool) -> None:
        """Fill `source`, and `forward` where media scatter forwards; `light` has begun the frame.

        `is_new`: walls or media are others than before, or the lattice has moved.
        """
        # Light that surfaces reflect, of lights and of the sky.
        with commands.stage("sky"):
            self._inject_sky(commands, is_new=is_new)
        with commands.stage("reflected"):
            self.light.inject_reflected(commands, self._target())
        with commands.stage("aggregate"):
            self._sum_up(commands, self.static, self.reflected)
        # Light that media scatter for the first time, or that comes in scattered from outside.
        with commands.stage("single-scattered"):
            is_gathered = self.light.settings.single == "gather"
            self.light.single.encode(
                commands,
                self.placement,
                self._cell_lights(self.kit.lights.count if is_gathered else 0),
                base=self.reflected,
                cells=self.source,
                fluence=self._fluence(is_sky=False),
            )
            self._inject_border(commands, frame, is_new=is_new)
            self._take_forward(commands, frame.scene)

    def _fluence(self, *, is_sky: bool) -> CellFluence | None:
        if not self._fluences:
            return None
        # The sky's light changes seldom; that of the lights comes on top.
        none, sky, light = self._fluences
        if is_sky:
            return CellFluence(None, sky)
        return CellFluence(sky if self.light.sky.has_any else none, light)

    @property
    def light_in_cells(self) -> Buffer:
        """All unscattered light in cells (`CellFluence`), where `EnteringLight` keeps it."""
        return self._fluences[-1]

    @property
    def beams(self) -> Buffer | None:
        """Unscattered light, W m, that marching reads from cells beside the scene's lights."""
        # Beams from the border are on top of the sky's already.
        if self._border:
            return self._border.beams
        return self._sky_forward if self._has_forward else None

    @property
    def surface_beams(self) -> Buffer | None:
        """Unscattered light, W m, that surfaces read: of the sky, and of lights deflected once."""
        return self.forward.all if self._has_forward else self._given_beams

    @property
    def _has_forward(self) -> bool:
        return self.light.media.has_forward

    @property
    def _given_beams(self) -> Buffer | None:
        """Those for surfaces without the lights' own."""
        return self._border.surface_beams if self._border else self.beams

    @property
    def _sky_forward(self) -> Buffer:
        has_any = self._has_forward and self.light.sky.has_any
        return self.forward.sky if has_any else self.black

    def _cell_lights(self, count: int) -> CellLights:
        return CellLights(self.kit.lights.bound, count, self.cells.blockers.walls)

    def _inject_sky(self, commands: Commands, *, is_new: bool) -> None:
        """Fill `static`, which changes only with environment, media, geometry or placement."""
        light = self.light
        if light.sky_key == self._static_key and not is_new:
            return
        self._static_key = light.sky_key
        # What media scatter once is what light that surfaces reflect is added to.
        base = self.black
        if light.sky.has_any:
            base = self._single_of_sky(commands)
            light.inject_sky(commands, self._target())
        self._sum_up(commands, base, self.static)

    def _single_of_sky(self, commands: Commands) -> Buffer:
        """The sky's light that media scatter once; and forwards, in `forward.sky`."""
        light, sky, walls = self.light, self.kit.sky, self.cells.blockers.walls
        lights = light.sky.cell_lights(walls, are_lit=light.settings.single != "off")
        # Where only media changed, only in cells that light reaches through those.
        versions = (sky.version, self.cells.blockers.version, self._has_forward)
        made = (light.sky.rows, replace(self.placement, fade=None), *versions)
        media = light.media.sky
        touched = media.touched_since(self._sky_media) if made == self._sky_made else None
        self._sky_made, self._sky_media = made, media.version
        shining = SkyLights(light.sky.buffer, lights.count, sky.maps, walls)
        self._stale.find(commands, touched, self.placement, shining)
        # Once, as isotropic power in each cell; then forwards, for what stays a beam.
        light.sky_single.encode(
            commands,
            self.placement,
            lights,
            base=self.black,
            cells=self._sky_single,
            fluence=self._fluence(is_sky=True),
            stale=self._stale,
        )
        if self._has_forward:
            black, stale = self.black, self._stale
            self.forward.encode_sky(commands, self.cells, lights, base=black, stale=stale)
        return self._sky_single

    def _inject_border(self, commands: Commands, frame: Frame, *, is_new: bool) -> None:
        """Add what an endless medium around the lattices sends into this one."""
        # What an endless medium scatters outside is that of its reduced medium.
        medium = reduced_scene(frame.scene).medium
        if self._border and medium:
            eye = frame.scene.camera.position
            top = float(medium_box(medium, *frame.bounds, eye)[1][1])
            # Light begins at the top of the medium and comes in from beyond the largest lattice.
            outside = Outside(medium, top, (*frame.scene.lights, *self.kit.sky.lights))
            places = (self.placement, self.kit.placement)
            blockers, walls = self.cells.blockers, self.cells.reflectance
            self._border.find(commands, outside, places, blockers, walls, is_new=is_new)
            self._border.encode(commands, self.source, self._sky_forward)

    def _take_forward(self, commands: Commands, scene: Scene) -> None:
        # On top of the sky's, and of what comes from outside.
        if self._has_forward:
            self.forward.encode(
                commands,
                self.cells,
                self._cell_lights(len(scene.lights)),
                base=self._given_beams or self.black,
            )

    def _target(self) -> InjectionTarget:
        walls, scale = self.cells.blockers.walls, self.light.scale
        return InjectionTarget(self.placement, walls, self._sums, scale)

    def _sum_up(self, commands: Commands, base: Buffer, cells: Buffer) -> None:
        # Sums are W sr^-1; cells hold power.
        unit = self.light.scale / (4.0 * np.pi)
        self.light.resolve.encode(commands, self.placement, self._sums, base, cells, unit)
