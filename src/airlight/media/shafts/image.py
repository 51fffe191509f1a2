"""The shafts of an image: the scheme that its settings choose, and where it can be interpolated."""

from __future__ import annotations

import numpy as np

from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.memory import Texture
from ...lighting.lights import Lights
from ...lighting.view import View
from ..gpu_media import GpuMedia
from ..pixel_list import PixelList, RedrawParams
from ..rays import Rays
from ..settings import MediaSettings
from .jitter import Jitter
from .shadow_rays import ShadowRays
from .shadow_volumes import Volumes
from .shafts import Shafts

COARSE_TEXEL = 1.0 / 80.0
"""The side of a reduced texel over its distance, beyond which shafts fit between texels. With fov_y
of 60 degrees that is half resolution of less than 185 rows, which have few pixels to draw."""


class ShaftImage:
    """Single scattering of lights along the rays of an image, full or reduced."""

    def __init__(
        self, gpu: Gpu, media: GpuMedia, lights: Lights, rays: Rays, settings: MediaSettings
    ) -> None:
        """Raises SettingsError for a scheme that cannot draw these media."""
        self._rays, self._wanted_contrast = rays, settings.shaft_contrast
        self.scheme = _scheme(gpu, media, lights, rays, settings)

    @property
    def can_list(self) -> bool:
        """Whether pixels that cannot be interpolated may be listed and redrawn."""
        return isinstance(self.scheme, Shafts) and self._wanted_contrast < 1.0

    def resize(self) -> None:
        """Go on with images of the size of the rays."""
        self.scheme.resize()

    def prepare(self, commands: Commands) -> None:
        """Compute what depends on shadow maps alone, after they changed."""
        self.scheme.prepare(commands)

    def encode(self, commands: Commands, lights: Lights, target: Texture) -> None:
        """Fill `target`, of the size of the reduced rays: radiance, W m^-2 sr^-1."""
        self.scheme.encode(commands, lights, target)

    def refine(
        self, commands: Commands, view: View, lights: Lights, reduced: Texture, target: Texture
    ) -> bool:
        """Fill the full-size `target` from `reduced`, with pixels redrawn; False if none may be."""
        # The scheme minmax alone can draw single pixels.
        contrast = self._contrast(view)
        if self._rays.scale == 1 or contrast >= 1.0 or not isinstance(self.scheme, Shafts):
            return False
        depth = view.gbuffer.depth
        self.scheme.refine(commands, lights, depth, reduced, target, contrast)
        return True

    def listing(self, view: View) -> tuple[RedrawParams, PixelList]:
        """What a pass binds to list pixels for `redraw`; where `can_list`."""
        assert isinstance(self.scheme, Shafts)
        return self.scheme.redrawn(self._contrast(view)), self.scheme.listed

    def redraw(self, commands: Commands, view: View, lights: Lights, target: Texture) -> None:
        """Redraw the listed pixels of the full-size `target`."""
        assert isinstance(self.scheme, Shafts)
        self.scheme.redraw(commands, lights, view.gbuffer.depth, target)

    def _contrast(self, view: View) -> float:
        """The contrast that interpolated texels may have; 0 where shafts fit between them."""
        # Small images have few pixels: all of them are drawn.
        wanted = self._wanted_contrast
        return 0.0 if wanted < 1.0 and self._texel_side(view) > COARSE_TEXEL else wanted

    def _texel_side(self, view: View) -> float:
        """The side of a reduced texel over its distance."""
        # Half the image is as high as the clip axis y is long, at a depth of 1.
        side = 2.0 * float(np.linalg.norm(view.world_from_clip[:3, 1])) / self._rays.size[1]
        return side * self._rays.scale


def _scheme(
    gpu: Gpu, media: GpuMedia, lights: Lights, rays: Rays, settings: MediaSettings
) -> Shafts | Jitter | Volumes:
    # The same light: cheap and noisy, for one homogeneous box, for any media.
    steps = settings.shaft_steps
    if settings.shafts == "jitter":
        return Jitter(gpu, media, rays, steps=steps)
    if settings.shafts == "volumes":
        return Volumes(gpu, media, lights, rays, tolerance=settings.volume_tolerance)
    shadows = ShadowRays(gpu, media, lights, max_nodes=settings.shaft_nodes, steps=steps)
    return Shafts(shadows, rays)
