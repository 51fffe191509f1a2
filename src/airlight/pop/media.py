"""The scattering media of a scene, each solved on a grid of its own, as sources for marching.

They shade and light one another; see `several_media`. Surfaces shade them, and light them by
virtual point lights or from the lattices that were solved before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import SceneError, SettingsError
from ..fields import ALL_MEDIA, SOME_MEDIA, Fields, Frame, Solver
from ..gpu.commands import Commands
from ..lighting.kit import Kit
from ..lighting.view import View
from ..maths.transforms import F64, triple
from ..media.gpu_media import GpuMedia
from ..media.reduced import reduced
from ..scene.coefficients import grouped
from ..scene.medium import medium_box
from ..scene.scene import Scene
from ..scene.volume import Volume
from .light.illumination import Illumination
from .light.importance import Look
from .light.visibility import Surfaces
from .medium.kinds import GridPlan
from .medium.merged_medium import MergedMedium
from .medium.mixture import BLOCKS, MediaCount
from .medium.surrounding import SurroundingMedium
from .settings import PopSettings, uses_virtual_grids
from .several_media import encode, introduce
from .solver import PopSolver
from .virtual.maps import reflected_maps

_FULL = 0.9  # of the largest buffer
_EYE_STEPS = 32  # along the longest side of what is lit
MediaOf = Callable[[Scene], list[Volume]]


class PopMedia(Solver):
    """Yields the radiance that media scatter towards the eye, on their grids."""

    def __init__(
        self,
        kit: Kit,
        media: GpuMedia,
        settings: PopSettings,
        plan: GridPlan,
        media_of: MediaOf | None = None,
        *,
        has_local_shafts: bool = False,
    ) -> None:
        """`media`: all that are marched, brought up to date by others; the last are solved here.

        `plan`: on which grids. `media_of`: the volumes of a scene that are, if not all.
        `has_local_shafts`: what local lights scatter once is drawn by shafts. Where those of a
        kind share a grid, they are all of `media`.
        """
        self.kit, self.settings, self._has_local_shafts = kit, settings, has_local_shafts
        self._media_of: MediaOf = media_of or (lambda scene: list(scene.volumes))
        self._solves_medium = media_of is not None
        self._scene, self._bounds = kit.context.scene, kit.context.scene.bounds
        # The parts of a volume of varying colour are one medium.
        _check_levels(settings, plan.volumes)
        self._first_row = media.count - sum(map(len, plan.volumes))
        # The surfaces around the media, with their virtual point lights.
        self._maps = reflected_maps(kit, settings)
        reflected = self._maps.reflected if self._maps else None
        self._surfaces: Surfaces | None = None
        if self._scene.meshes:
            self._surfaces = Surfaces(
                kit.meshes, kit.lights, kit.sky, kit.rays, kit.blockers, reflected
            )
        # Few media have a grid each, many share one with those of their kind.
        self._merged: list[MergedMedium] = []
        if plan.kinds:
            self.solvers = self._made_of_kinds(plan, media)
        else:
            self.solvers = self._made(plan.volumes, media)
        # Each meets the others once all have their grids.
        introduce(self.solvers)

    def _made(self, volumes: list[tuple[Volume, ...]], media: GpuMedia) -> list[PopSolver]:
        """A solver for each volume or its parts; a grid with its own texture is there already."""
        lights = self._most_lights
        # A grid alone on the device is read where it lies, not uploaded twice.
        shared = media.atlas.texture if media.atlas is not None and media.atlas.is_alone else None
        # Each solver has the kernels for all media that its own may meet.
        every = sum(map(len, volumes))
        return [
            PopSolver(
                self.kit.gpu,
                parts,
                self.settings,
                lights=lights,
                voxels=shared if parts[0].density is not None else None,
                has_local_shafts=self._has_local_shafts,
                others=MediaCount(others=len(volumes) - 1, other_parts=every - len(parts)),
            )
            for parts in volumes
        ]

    @property
    def _most_lights(self) -> int:
        """Beside the environment: those of the scene, and virtual ones."""
        virtual = self._surfaces.virtual_lights if self._surfaces else 0
        return len(self._scene.lights) + virtual

    def _made_of_kinds(self, plan: GridPlan, media: GpuMedia) -> list[PopSolver]:
        """A solver for each kind; together they have an eighth of the volumes' cells, if there is
        room, and one volume's at least."""
        gpu, settings, lights = self.kit.gpu, self.settings, self._most_lights
        every, kinds = [part for parts in plan.volumes for part in parts], plan.kinds
        others = MediaCount(others=len(kinds) - 1, other_parts=len(kinds) - 1)
        # Paths to every light, through every kind, are stored in each cell.
        paths = len(kinds) * (settings.ordinates + lights + BLOCKS * others.others)
        most = gpu.limits["max-storage-buffer-binding-size"] / (8 * paths)
        wanted = settings.grid**3 * max(1.0, len(plan.volumes) / 2**3) / len(kinds)
        # A kind adds up its volumes from their rows in the table of media.
        for kind in kinds:
            cells = min(wanted, _FULL * most)
            rows = [self._first_row + i for i in kind]
            self._merged.append(
                MergedMedium(gpu, media, [every[i] for i in kind], cells, rows=rows, others=others)
            )
        return [
            PopSolver(
                gpu,
                medium,
                settings,
                lights=lights,
                others=others,
                has_local_shafts=self._has_local_shafts,
            )
            for medium in self._merged
        ]

    def _volumes(self, scene: Scene) -> list[tuple[Volume, ...]]:
        """Those that solvers take in a frame."""
        volumes = self._media_of(scene)
        if not self._merged:
            return grouped(volumes)
        # Those of a kind are one medium, with the means of what they are in this frame.
        return [
            (medium.volume_of([volumes[i - self._first_row] for i in medium.rows]),)
            for medium in self._merged
        ]

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """Take the scene, and what surfaces reflect; media are solved for a view."""
        self._scene, self._bounds = frame.scene, frame.bounds
        if self._maps:
            with commands.stage("reflective shadow maps"):
                self._maps.encode(commands, frame.scene, *frame.bounds)
        return fields

    def solve_view(self, commands: Commands, view: View, fields: Fields) -> Fields:
        """Solve every medium, and yield the radiance that it scatters towards the eye of `view`."""
        scene = self._scene
        # Indirect light comes from virtual point lights or from lattices, not from both.
        has_reflected = self._maps is None
        # All that lights media: lights, sky, the eye and what surfaces reflect.
        lit = Illumination(
            scene.lights,
            scene.environment,
            np.asarray(view.eye, np.float64),
            self._surfaces,
            fields.reflected if has_reflected else None,
            Look(view.camera, view.size[0] / view.size[1]),
            self._around(np.asarray(view.eye)),
        )
        encode(commands, self.solvers, self._volumes(scene), lit)
        # What each medium scatters, by its rows in the table of media.
        sources, row = [], self._first_row
        for solver in self.solvers:
            sources += solver.sources(row)
            row += len(solver.medium.parts)
        # The grid of a kind lights whatever there is of it at a point.
        if len(self._merged) == 1:
            sources = [replace(source, medium=ALL_MEDIA) for source in sources]
        elif self._merged:
            sources = [
                replace(source, medium=SOME_MEDIA, members=medium.rows)
                for source, medium in zip(sources, self._merged, strict=True)
            ]
        return replace(fields, volumes=tuple(sources))

    def _around(self, eye: F64) -> SurroundingMedium | None:
        """The scene's own medium, where a lattice has it."""
        medium = self._scene.medium
        if medium is None or self._solves_medium:
            return None
        # Fog without bounds reaches to the eye, in steps, so that not every move is another light.
        step = float(np.subtract(*self._bounds[::-1]).max()) / _EYE_STEPS
        eye = step * np.round(eye / max(step, 1e-30))
        low, high = medium_box(medium, *self._bounds, eye)
        return SurroundingMedium(tuple(low), tuple(high), reduced(medium).sigma_t)

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        return self.solvers[0].stats if self.solvers else {}


def _check_levels(settings: PopSettings, volumes: list[tuple[Volume, ...]]) -> None:
    """Raises SettingsError where nested grids are asked for and cannot be had."""
    # Nested grids hand on the diffuse light of one medium; hops and other media have no part in it.
    if settings.grid_levels == 1 or not volumes:
        return
    name = f"grid_levels = {settings.grid_levels}"
    if uses_virtual_grids(settings, alone=True):
        raise SettingsError(
            f"{name} is for scheme = 'delta-beam' with virtual_grids = 'beams'",
            remedy="Use those, or grid_levels = 1",
        )
    if sum(map(len, volumes)) > 1:
        raise SettingsError(
            f"{name} is for a medium that is alone and of one colour, the scene has several",
            remedy="Use grid_levels = 1, with a larger grid",
        )


class EveryMedium:
    """The scene's own medium as a box of density 1, and its volumes.

    A medium without bounds keeps the box of the first frame: its grid does not follow the camera.
    """

    def __init__(self, scene: Scene) -> None:
        """Raises SceneError where the scene's medium is endless."""
        self._box = _medium_box(scene)

    def __call__(self, scene: Scene) -> list[Volume]:
        """The media in the order of `media.gpu_media`."""
        m = scene.medium
        if m is None or self._box is None:
            return list(scene.volumes)
        # What fills the scene is a volume like the others, in the box that it had at first.
        low, high = self._box
        bounds = (triple(low), triple(high)) if m.bounds is None else m.bounds
        box = Volume(m.sigma_t, shape="box", bounds=bounds, albedo=m.albedo, g=m.g)
        return [box, *scene.volumes]


def _medium_box(scene: Scene) -> tuple[F64, F64] | None:
    """The box of the scene's own medium, metres. Raises SceneError where it is endless."""
    medium = scene.medium
    if medium is None:
        return None
    if medium.endless:
        raise SceneError(
            "an endless medium does not fit into the grid of pop",
            remedy="Use technique lpv-scatter, or give the medium bounds",
        )
    return medium_box(medium, *scene.bounds, scene.camera.position)
