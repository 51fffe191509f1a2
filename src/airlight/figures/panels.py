"""Panels of a figure: rendered alike, exposed alike, joined on one sheet."""

from __future__ import annotations

import dataclasses
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..app.compare.images import contact_sheet, shown
from ..maths.arrays import U8
from ..maths.colour import luminance
from ..maths.tone import auto_exposure
from ..scene.camera import Camera
from ..scene.checks import F32
from ..scene.image import Image
from ..scene.material import Material, Texture
from ..scene.mesh import Mesh
from ..scene.scene import Scene

if TYPE_CHECKING:
    from ..rendering import Renderer

Report = Callable[[str, float], None]

QUICK: Mapping[str, Any] = {
    "resolution": 12,
    "iterations": 4,
    "map_resolution": 32,
    "shadow_resolution": 256,
    "lamp_resolution": 64,
    "sky_lights": 8,
    "surfels": 20_000,
}
"""Settings of every panel with --quick, unless the figure is about them."""
LATTICE_ALONE: Mapping[str, Any] = {"gather": "off"}
"""Of every panel, unless the figure is about it: stills gather their indirect light along rays by
default, and what a lattice does then hardly shows."""
MIN_SHEET_CELL_PX = 240  # captions need room
CAPTION_PX = 14
CAPTIONS_IN_WIDTH = 110  # of a sheet: captions are read when the whole sheet is on a screen
TIMED_FRAMES = 4


@dataclass(frozen=True)
class Request:
    """How a figure is to be made: `size` (width, height) of a panel in pixels.

    `quick` asks for tiny lattices and noisy references: does it work? `warn` is told what the
    figure has to go without on this machine.
    """

    size: tuple[int, int] = (640, 360)
    quick: bool = False
    adapter: str = "auto"
    report: Report = lambda stage, fraction: None
    warn: Callable[[str], None] = lambda text: None

    @property
    def samples(self) -> int:
        """Jittered samples a pixel."""
        return 1 if self.quick else 8

    @property
    def reference_spp(self) -> int:
        """Samples a pixel of a path-traced panel."""
        return 4 if self.quick else 1024


@dataclass(frozen=True, eq=False)
class Drawn:
    """A figure: its image (H, W, 3) and what it says in numbers."""

    image: U8
    numbers: dict[str, Any]


def rendered(
    request: Request,
    scene: Scene,
    settings: Mapping[str, Any] | None = None,
    *,
    technique: str = "lpv",
    timed: bool = False,
) -> Image:
    """A panel. `timed` puts the milliseconds of steady frames into stats["frame_ms"].

    Raises SettingsError, DeviceError.
    """
    # The first frame compiles; the median is of those after it.
    with renderer(request, scene, settings or {}, technique=technique) as made:
        for _ in range(TIMED_FRAMES + 1 if timed else 0):
            made.frame(read=False)
        steady = made.frame_ms[1:]
        image = made.frame(samples=request.samples)
    assert image is not None
    stats = dict(image.stats) | ({"frame_ms": statistics.median(steady)} if steady else {})
    return dataclasses.replace(image, stats=stats)


def renderer(
    request: Request, scene: Scene, settings: Mapping[str, Any], *, technique: str = "lpv"
) -> Renderer:
    """A Renderer for panels, with `settings` over those of all panels and of --quick.

    Raises SettingsError, DeviceError.
    """
    from ..rendering import Renderer

    # Every figure's panels have these, unless it says otherwise.
    kept = known(technique, {**LATTICE_ALONE, **(QUICK if request.quick else {})})
    return Renderer(
        scene, technique, request.size, settings={**kept, **settings}, adapter=request.adapter
    )


def known(technique: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Those of `settings` that the technique has."""
    from ..techniques import technique_settings

    names = {f.name for f in dataclasses.fields(technique_settings(technique))}
    return {name: value for name, value in settings.items() if name in names}


def mean_light(radiance: F32) -> float:
    """The mean luminance, W m^-2 sr^-1."""
    return float(np.mean(luminance(radiance)))


def away(image: NDArray[Any], other: NDArray[Any]) -> float:
    """Relative L2 of an image from another."""
    return float(np.linalg.norm(image - other) / max(float(np.linalg.norm(other)), 1e-30))


def exposure_of(scene: Scene, radiance: F32) -> float:
    """The camera's stops; where it has none, what suits the image."""
    stops = scene.camera.exposure_stops
    return float(auto_exposure(radiance)) if stops is None else stops


def sheet(
    request: Request, title: str, rows: Sequence[tuple[str, Sequence[tuple[str, U8 | None]]]]
) -> U8:
    """Panels in rows, captions above."""
    # Captions grow with the sheet: it is read when it is shown whole.
    width_px = max(request.size[0], MIN_SHEET_CELL_PX)
    columns = max(len(cells) for _, cells in rows)
    readable = min(columns * width_px // CAPTIONS_IN_WIDTH, width_px // 24)
    caption_px = max(CAPTION_PX, readable)
    return contact_sheet(title, rows, cell_width_px=width_px, caption_px=caption_px)


def exposed(images: Sequence[tuple[str, F32]], stops: float) -> list[Any]:
    """Captioned radiance as captioned images."""
    return [(label, shown(radiance, stops)) for label, radiance in images]


def from_here(scene: Scene, position: Any, target: Any, fov_y_deg: float = 55.0) -> Scene:
    """The scene seen from elsewhere; exposure as it was."""
    stops = scene.camera.exposure_stops
    camera = Camera(tuple(position), tuple(target), fov_y_deg=fov_y_deg, exposure_stops=stops)
    return dataclasses.replace(scene, camera=camera)


def in_clay(scene: Scene, reflectance: float = 0.6) -> Scene:
    """Every surface grey and matt, cut-outs kept: light alone, as Kaplanyan2010 Fig. 6."""
    # Materials are replaced once each, so that instances stay instances.
    made: dict[int, Material] = {}
    for mesh in scene.meshes:
        if id(mesh.material) not in made:
            made[id(mesh.material)] = _clay(mesh.material, reflectance)
    meshes = tuple(
        Mesh(m.geometry, made[id(m.material)], m.world_from_object, m.name) for m in scene.meshes
    )
    return dataclasses.replace(scene, meshes=meshes)


def _clay(material: Material, reflectance: float) -> Material:
    # Only a texture that cuts holes is needed, for its alpha.
    texture = material.base_color_texture
    cut = texture if material.alpha_cutoff > 0.0 else None
    return Material(
        name=f"{material.name} in clay",
        base_color=(reflectance,) * 3,
        base_color_texture=None if cut is None else _white(cut),
        alpha=material.alpha,
        alpha_cutoff=material.alpha_cutoff,
        specular=0.0,
        emission=material.emission,
        two_sided=material.two_sided,
    )


def _white(texture: Texture) -> Texture:
    """Its alpha, white."""
    pixels = np.full_like(texture.pixels, 255)
    pixels[..., 3] = texture.pixels[..., 3]
    return dataclasses.replace(texture, pixels=pixels, source=f"{texture.source} in clay")
