"""What every technique is: solvers in an order, surfaces lit by their fields, media before them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, TypeVar

from ..fields import Fields, Frame, Solver
from ..gpu.commands import Commands
from ..gpu.memory import Texture
from ..lighting.kit import Kit
from ..lighting.surfaces import Surfaces
from ..lighting.view import View
from ..scene.scene import Scene

if TYPE_CHECKING:
    from ..media.media import Media

_T = TypeVar("_T")
SceneFilter = Callable[[Scene], Scene]
Layers = Callable[[View], dict[str, Texture]]


class Technique:
    """Made once for a scene, then used for any number of frames; see `recipes`.

    `name`: of the recipe. `solve` is everything that no view matters for, `draw` writes the layers
    of one. `media` is one of the solvers, where media are drawn at all.
    """

    def __init__(
        self,
        name: str,
        kit: Kit,
        solvers: Sequence[Solver] = (),
        *,
        media: Media | None = None,
        scene_filter: SceneFilter | None = None,
        layers: Layers | None = None,
    ) -> None:
        """`scene_filter`: the scene that solvers are given. `layers`: what is read, if not all."""
        self.name, self.kit, self.solvers, self.media = name, kit, tuple(solvers), media
        self._scene_filter = scene_filter or (lambda scene: scene)
        air = media.on_device if media else None
        self.surfaces = Surfaces(kit, kit.context.scene, air)
        self._layers = layers or (media.layers if media else _surface_layers)
        self.fields: Fields | None = None

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Lights, sky and lattices, then each solver, which sees the fields of those before it."""
        scene = self._scene_filter(scene)
        frame = Frame(scene, *self.kit.bounds(scene))
        self.kit.encode(commands, scene, *frame.bounds)
        fields = Fields(self.kit.sky_irradiance)
        for solver in self.solvers:
            fields = solver.solve(commands, frame, fields)
        self.fields = fields

    def draw(self, commands: Commands, view: View) -> None:
        """Surfaces, then media before them."""
        assert self.fields is not None, "solve comes first"
        fields = self.fields
        for solver in self.solvers:
            fields = solver.solve_view(commands, view, fields)
        irradiance = fields.irradiance or self.kit.no_irradiance
        self.surfaces.draw(commands, view, irradiance, fields.sky)
        if self.media:
            self.media.draw(commands, view, fields)

    def pictures(self, view: View) -> dict[str, Texture]:
        """The layers that `draw` wrote, by name; those that are radiance add up to the image."""
        return self._layers(view)

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with images of `size`, pixels; what was solved stays."""
        if self.media:
            self.media.resize(size)

    def find(self, kind: type[_T]) -> _T | None:
        """The first solver of a kind."""
        return next((solver for solver in self.solvers if isinstance(solver, kind)), None)

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats; where several say so, the first solver's word."""
        found = self.kit.stats
        for solver in reversed(self.solvers):
            found |= solver.stats
        return {"chosen": self.name, **found}

    def release(self) -> None:
        """Give the memory back: the solvers' own, then all that was made with the kit's `gpu`."""
        with ExitStack() as gone:
            gone.callback(self.kit.gpu.release)
            for solver in self.solvers:
                gone.callback(solver.release)


def _surface_layers(view: View) -> dict[str, Texture]:
    """The layers of surfaces alone."""
    return {"direct": view.layers.direct, "indirect": view.layers.indirect}
