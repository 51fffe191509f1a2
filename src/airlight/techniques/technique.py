"""The one class of technique: solvers in an order, then surfaces and media lit by their fields."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import fields as fields_of
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from ..fields import Fields, Frame, Solver
from ..gpu.commands import Commands
from ..gpu.memory import Texture
from ..lighting.kit import Kit
from ..lighting.surfaces import Surfaces
from ..lighting.translucent import Translucent
from ..lighting.view import View
from ..scene.scene import Scene

if TYPE_CHECKING:
    from ..media.media import Media

_T = TypeVar("_T")
SceneFilter = Callable[[Scene], Scene]
Layers = Callable[[View], dict[str, Texture]]
Views = Callable[[Kit, Any], list[Solver]]


class Technique:
    """A list of solvers for one scene, used for any number of frames; `recipes` makes them.

    `solve` brings all fields up to date for a scene, independent of any view; `draw` writes the
    layers of one view.
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
        views: Views | None = None,
    ) -> None:
        """`name`: of the recipe. `media`: the one of the solvers that draws media, if any does.

        `scene_filter`: what solvers are given in place of the scene. `layers`: the textures of a
        view that make its image; by default all that `media`, or else surfaces, wrote. `views`: of
        a kit and settings, the solvers that other views of the same solution have of their own
        (`beside`); None where stills have another solution, or solvers write what an eye sees.
        """
        self.name, self.kit, self.solvers, self.media = name, kit, tuple(solvers), media
        self._scene_filter, self.views = scene_filter or (lambda scene: scene), views
        # What draws: surfaces in media, and translucent ones before them.
        attenuation = media.on_device if media else None
        self.surfaces = Surfaces(kit, kit.context.scene, attenuation)
        self._layers = layers or (media.layers if media else _surface_layers)
        self.translucent: Translucent | None = None
        most = kit.settings.translucent_layers
        if most and kit.meshes.has_translucent:
            self.translucent = Translucent(kit.gpu, kit.context.size, most)
        self._seen: dict[str, Texture] | None = None  # through translucent surfaces
        self.fields: Fields | None = None
        self.frame: Frame | None = None  # that was solved last
        self._added: dict[int, dict[str, Any]] = {}  # by each solver, in the last frame it solved

    def solve(
        self, commands: Commands, scene: Scene, *, is_still: bool = False, lags: bool = False
    ) -> None:
        """Update lights, sky and lattices, then run each solver on the fields of those before.

        `is_still`: for an image of several samples. `lags`: solvers that may lag leave their fields
        as they were; nothing but lights and sky may have changed since.
        """
        # Solvers may be given other media than the scene's; lights with extent become samples, and
        # lights that the eye sees nothing of are dark.
        scene = self.kit.lit(self._scene_filter(scene))
        frame = Frame(scene, *self.kit.bounds(scene), is_still=is_still)
        # What all solvers share: shadow maps, blockers, the sky's light in all cells.
        self.kit.encode(commands, scene, *frame.bounds)
        # Each solver adds its fields to those of the solvers before it.
        fields = Fields(self.kit.sky_irradiance)
        for index, solver in enumerate(self.solvers):
            if lags and solver.may_lag and index in self._added:
                fields = replace(fields, **self._added[index])
                continue
            before, fields = fields, solver.solve(commands, frame, fields)
            self._added[index] = _changes(before, fields)
        self.fields, self.frame = fields, frame

    def draw(self, commands: Commands, view: View) -> None:
        """Draw the view's surfaces, then the media in front of them."""
        assert self.fields is not None, "solve comes first"
        fields = self.fields
        # Solvers add what depends on the eye; they leave the fields of `solve` as they are.
        for solver in self.solvers:
            fields = solver.solve_view(commands, view, fields)
        irradiance = fields.irradiance or self.kit.no_irradiance
        self.surfaces.draw(commands, view, irradiance, fields.sky, fields.gathered)
        if self.translucent:
            # Layers of translucent surfaces, from the eye on, each with the media before it.
            for layer in self.translucent.layers(view, self.kit.meshes):
                self.surfaces.draw(commands, layer, irradiance, fields.sky)
                if self.media:
                    self.media.draw(commands, layer, fields)
                self.translucent.add(commands, self._layers(layer))
        if self.media:
            self.media.draw(commands, view, fields)
        if self.translucent:
            self._seen = self.translucent.finish(commands, self._layers(view))

    def layers(self, view: View) -> dict[str, Texture]:
        """The textures that `draw` wrote, by layer; the layers of radiance add up to the image."""
        return self._layers(view) if self._seen is None else self._seen

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on; the solved fields stay."""
        if self.media:
            self.media.resize(size)
        if self.translucent:
            self.translucent.resize(size)
            self._seen = None

    def find(self, kind: type[_T]) -> _T | None:
        """The first solver of a kind."""
        return next((solver for solver in self.solvers if isinstance(solver, kind)), None)

    def jitters(self, samples: int) -> int:
        """How many images make each of a still's `samples`, each with a jitter of its own."""
        return max((solver.jitters(samples) for solver in self.solvers), default=1)

    @property
    def follows_eye(self) -> bool:
        """Whether lattices reach as far into a medium as the scene's cameras see."""
        return self.media is not None and not self.kit.settings.bounds

    @property
    def stats(self) -> dict[str, Any]:
        """The values of --stats; where two solvers have the same key, the first one's counts."""
        found = self.kit.stats
        # What earlier solvers say stands, where later ones say it too.
        for solver in reversed(self.solvers):
            found |= solver.stats
        return {"chosen": self.name, **found}

    def release(self) -> None:
        """Give the memory back: the solvers' own, then all that was made with the kit's `gpu`."""
        # Solvers go before the memory that they hold, whatever one of them raises.
        with ExitStack() as gone:
            gone.callback(self.kit.gpu.release)
            for solver in self.solvers:
                gone.callback(solver.release)


def _surface_layers(view: View) -> dict[str, Texture]:
    """The layers of surfaces alone."""
    return {"direct": view.layers.direct, "indirect": view.layers.indirect}


def _changes(before: Fields, after: Fields) -> dict[str, Any]:
    """What a solver added."""
    # Fields are values: what a solver did not add is the same object as before.
    names = [f.name for f in fields_of(Fields)]
    return {n: getattr(after, n) for n in names if getattr(after, n) is not getattr(before, n)}
