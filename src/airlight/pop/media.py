"""All scattering media of a scene: each solved on its own grid, all marched together.

They shade and light one another; see `together`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import SceneError
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.view import View
from ..march.air import Air
from ..march.guided import GuidedUpsample
from ..march.march import MAX_SOURCES, March
from ..march.rays import RESOLUTIONS, RayParams, Rays
from ..march.upsample import Upsample
from ..maths.transforms import F64
from ..scene.medium import medium_box
from ..scene.scene import Scene
from ..scene.settings import setting
from ..scene.volume import Volume
from .importance import Look
from .settings import PopSettings
from .sharp_lobes import SharpLobes
from .solver import Frame, PopSolver
from .together import encode, introduce
from .visibility import Surfaces


@dataclass(frozen=True)
class PopMediaSettings(PopSettings):
    """How media are solved and marched."""

    march: str = setting("half", "resolution of the marched picture", choices=tuple(RESOLUTIONS))
    march_steps: int = setting(128, "most steps of a view ray", low=8, high=1024)


class PopMedia:
    """Light scattered by every medium of a scene, and how much of what lies behind comes through.

    `solve` once per frame, then `draw` for each view; `scattered` and `transmittance` are of the
    view's size. Raises SceneError for more media than can be marched at once.
    """

    Settings = PopMediaSettings

    def __init__(
        self, gpu: Gpu, scene: Scene, settings: PopMediaSettings, surfaces: Surfaces | None = None
    ) -> None:
        """`surfaces`: what shades the media, solved before them in every frame."""
        self.gpu, self.settings, self._surfaces = gpu, settings, surfaces
        self._lobes = SharpLobes()
        scene = self._dulled(scene)
        self._fog = _fog_box(scene)
        media = self._volumes(scene)
        if len(media) > MAX_SOURCES:
            raise SceneError(
                f"the scene has {len(media)} media, at most {MAX_SOURCES} can be drawn",
                remedy="Leave some out.",
            )
        self.air = Air(gpu, scene, light_count=0, solved=scene.volumes)
        grids = iter(self.air.grids)
        lights = len(scene.lights) + (surfaces.virtual_lights if surfaces else 0)
        self.solvers = [
            PopSolver(gpu, volume, settings, lights=lights,
                      voxels=next(grids) if volume.density is not None else None,
                      others=len(media) - 1)
            for volume in media
        ]  # fmt: skip
        introduce(self.solvers)
        self._march = March(gpu, self.air, sources=len(self.solvers))
        self._upsample = Upsample(gpu)
        self._guided = GuidedUpsample(gpu, self.air)
        self._scene = scene
        self._picture: _Picture | None = None

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Take the scene as it is now."""
        scene = self._dulled(scene)
        self._scene = scene
        with commands.stage("air"):
            self.air.update(commands, scene, *scene.bounds)

    def draw(self, commands: Commands, view: View) -> None:
        """Fill `scattered` and `transmittance` for a view whose G-buffer is drawn."""
        scene, picture = self._scene, self._of_size(view.size)
        look = Look(view.camera, view.size[0] / view.size[1])
        frame = Frame(scene.lights, scene.environment, np.asarray(view.eye, np.float64),
                      self._surfaces, look=look)  # fmt: skip
        encode(commands, self.solvers, self._volumes(scene), frame)
        with commands.stage("march"):
            rays = picture.rays.encode(commands, view)
            self._march.encode(
                commands, rays, picture.rays,
                sources=[s.source(row) for row, s in enumerate(self.solvers)],
                scattered=picture.reduced_scattered, transmittance=picture.reduced_passed,
                max_steps=self.settings.march_steps,
            )  # fmt: skip
        with commands.stage("upsample"):
            self._finish(commands, rays, picture, view.gbuffer.depth)

    def _finish(
        self, commands: Commands, rays: RayParams, picture: _Picture, depth: Texture
    ) -> None:
        """The marched picture at full size."""
        if picture.rays.scale > 1:
            self._guided.encode(
                commands, rays, picture.rays, self._march, depth,
                scattered=picture.reduced_scattered, transmittance=picture.reduced_passed,
                targets=(picture.scattered, picture.passed),
            )  # fmt: skip
            return
        for reduced, target in picture.pairs:
            self._upsample.encode(commands, rays, picture.rays, depth, reduced, target)

    @property
    def scattered(self) -> Texture:
        """Radiance, W m^-2 sr^-1, rgba32float, of the last view drawn."""
        assert self._picture is not None
        return self._picture.scattered

    @property
    def transmittance(self) -> Texture:
        """Of the air up to each pixel's surface, rgba32float, of the last view drawn."""
        assert self._picture is not None
        return self._picture.passed

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        return self.solvers[0].stats if self.solvers else {}

    def release(self) -> None:
        """Give the memory back."""
        for solver in self.solvers:
            solver.release()
        self._march.release()
        self.air.release()
        if self._picture:
            self._picture.release()

    def _volumes(self, scene: Scene) -> list[Volume]:
        """The media in `march.air`'s order; a homogeneous one as a box of density 1.

        Air without bounds keeps the box it had at first: its grid does not follow the camera.
        """
        m = scene.medium
        if m is None or self._fog is None:
            return list(scene.volumes)
        low, high = self._fog
        bounds = (_corner(low), _corner(high)) if m.bounds is None else m.bounds
        box = Volume(m.sigma_t, shape="box", bounds=bounds, albedo=m.albedo, g=m.g)
        return [box, *scene.volumes]

    def _dulled(self, scene: Scene) -> Scene:
        """As it is solved; the paper's scheme takes every lobe as it is."""
        return scene if self.settings.scheme == "paper" else self._lobes.dulled(scene)

    def _of_size(self, size: tuple[int, int]) -> _Picture:
        if self._picture is None or self._picture.rays.size != size:
            if self._picture:
                self._picture.release()
            self._picture = _Picture(self.gpu, size, RESOLUTIONS[self.settings.march])
        return self._picture


class _Picture:
    """The textures of one size of picture."""

    def __init__(self, gpu: Gpu, size: tuple[int, int], scale: int) -> None:
        self.rays = Rays(gpu, size, scale)
        small = self.rays.reduced
        self.reduced_scattered, self.reduced_passed = (
            Texture(gpu, f"marched {name}", small, "rgba32float", target=True)
            for name in ("scattered", "transmittance")
        )
        self.scattered, self.passed = (
            Texture(gpu, name, size, "rgba32float", target=True)
            for name in ("scattered", "transmittance")
        )

    @property
    def pairs(self) -> tuple[tuple[Texture, Texture], ...]:
        return ((self.reduced_scattered, self.scattered), (self.reduced_passed, self.passed))

    def release(self) -> None:
        for part in (
            self.rays,
            self.reduced_scattered,
            self.reduced_passed,
            self.scattered,
            self.passed,
        ):
            part.release()


def _fog_box(scene: Scene) -> tuple[F64, F64] | None:
    """Where the scene's own medium is, metres. Raises SceneError where that has no end."""
    medium = scene.medium
    if medium is None:
        return None
    if medium.endless:
        raise SceneError(
            "endless air does not fit into the grid of pop",
            remedy="Use technique lpv-scatter, or give the medium bounds",
        )
    return medium_box(medium, *scene.bounds, scene.camera.position)


def _corner(point: F64) -> tuple[float, float, float]:
    return (float(point[0]), float(point[1]), float(point[2]))
