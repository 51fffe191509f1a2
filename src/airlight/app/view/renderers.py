"""The renderers of a viewer's session: made in the background, finer ones, others compared."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from ...gather.solver import GatherSolver
from ...gpu.device import open_gpu
from ...rendering import Renderer
from ...scene.placing import camera_at
from ...scene.scene import Scene
from ...techniques import checked_settings
from ...techniques.beside import settings_of_views
from .build import Turns, said
from .document import Document
from .drawn import Drawn
from .fine import SAMPLES, Fine, Seen, Shot
from .finer import finer_settings
from .making import PREVIEW, PREVIEW_SETTINGS, PREVIEW_TECHNIQUE, BackgroundRenderer, Making
from .quality import STILL_SAMPLES, Quality
from .second_view import SecondView, can_show
from .shown import Shown
from .source import Source
from .state import ViewState, boxes, structure

COARSER_SAMPLES = 8
"""Of a still view, before a finer image is begun, which then has as many before it is shown.

But for gathered ones, which come the sooner: of the living room 16 plain ones are hardly better."""
FIRST_IMAGE, PREPARING, REBUILDING = "first image ...", "preparing ...", "rebuilding ..."
MAKING = (FIRST_IMAGE, PREPARING, REBUILDING)
"""Notices while a renderer is being made."""
_LEAD = 2
"""Samples that the compared image may have more than the finer one."""
GATHER_HISTORY = 16
"""Frames that those of a moving view go on from where they gather."""


class Renderers(Document):
    """A document with what draws it: the renderer that is seen (`renderer`), the next one while it
    is made, a finer one (`fine`) and one of another technique (`compared`) for static views.
    """

    def __init__(
        self,
        scene: Scene,
        source: str,
        technique: str,
        settings: Mapping[str, Any] | None,
        adapter: str,
        model: Mapping[str, Any] | None,
    ) -> None:
        # Wrong settings are refused before a device is asked for.
        checked_settings(technique, scene, settings or {})
        self.gpu, self._adapter = open_gpu(adapter), adapter
        own = {technique: dict(settings)} if settings else {}
        super().__init__(Source(source, scene, model), ViewState(scene, technique, own))
        self.quality = Quality(is_cpu=self.gpu.is_cpu)
        self._turns = Turns()
        self._making, self.fine = Making(self.gpu, self._turns), Fine(self.gpu, self._turns)
        self.compared, self._compared_is = Fine(self.gpu, self._turns), ""
        self._shown = Shown(self.gpu)
        self._drawn: Drawn | None = None
        self._shot: Shot | None = None
        self._size = (1, 1)
        self._made: tuple[Any, ...] | None = None
        self._eye: tuple[float, float, float] | None = None  # that lattices in fog reach to
        self._refused: tuple[Any, ...] | None = None
        self._finest_of: object = None  # the technique whose solution the finest image shows
        # Moving frames gather on GPUs, until they prove too slow for it.
        self._gathers_moving = not self.gpu.is_cpu

    @property
    def renderer(self) -> Renderer | None:
        """What draws while the view moves; None until the first was made."""
        return self._drawn.renderer if self._drawn else None

    @property
    def wanted(self) -> tuple[Any, ...]:
        """What a renderer is made for: the state's structure, where its volumes' grids lie now, and
        an eye far out in its fog."""
        return (*structure(self.state), boxes(self.state), self._eye)

    def wait(self) -> None:
        """Return once the renderer that is being made is there, or has been refused."""
        if self._making.is_under_way:
            self._take_made()

    def _make(self) -> None:
        """See that there is, or will be, a renderer for the state's structure."""
        if self._making.has_ended:
            self._take_made()
        self._look_beyond()
        state, wanted = self.state, self.wanted
        # A structure that is drawn already, or was refused, needs nothing new.
        if wanted in (self._made, self._refused):
            if self._making.is_under_way:  # of a wish that was taken back
                self._making.give_up()
                self._say_made()
            return
        # While a sequence plays whose grids change their boxes, what is begun is made to its end.
        making = self._making.wanted
        if state.is_playing and making is not None and making[:-2] == wanted[:-2]:
            return
        state.notice = REBUILDING if self._made not in (None, PREVIEW) else PREPARING
        self.fine, self.compared = self._emptied(self.fine), self._emptied(self.compared)
        # The first image is a coarse one: there is something to see as soon as may be.
        size = self.quality.coarse(self._size)
        if self._drawn is None and self._refused is None and state.technique != PREVIEW_TECHNIQUE:
            state.notice = FIRST_IMAGE
            self._making.begin(PREVIEW, self._maker(size, PREVIEW_TECHNIQUE, PREVIEW_SETTINGS))
        else:
            make = self._maker(size, state.technique, self._moving(), eye=self._eye)
            free = self.controls.free

            def made() -> Renderer:
                if free is not None:  # the first drag asks for it
                    free.warm()
                return make()

            self._making.begin(wanted, made)

    def _look_beyond(self) -> None:
        """Lattices that end before what the camera sees of the fog are made again, larger.

        They stay so when it comes back: who goes out and in waits once. What is drawn at rest is
        made for the camera as it is.
        """
        if self._made is None or self._made[:-2] != structure(self.state):
            self._eye = None  # what is made now is made for the camera as it is
        elif self.renderer and self.renderer.made_for.reach:
            self._eye = self.renderer.made_for.reach.beyond(self.scene_now()) or self._eye

    def _emptied(self, fine: Fine) -> Fine:
        """One of which nothing was made; what `fine` holds is given back in the background."""
        if fine.is_empty:
            return fine
        fine.retire()
        return Fine(self.gpu, self._turns)

    def _maker(
        self,
        size: tuple[int, int],
        technique: str,
        more: Mapping[str, Any] | None = None,
        *,
        eye: tuple[float, float, float] | None = None,
    ) -> Callable[[], Renderer]:
        """Makes a renderer of the state as it is now, with `more` settings; seen from `eye`."""
        scene, adapter = self.scene_now(), self._adapter
        if eye is not None:
            scene = replace(scene, camera=camera_at(scene.camera, eye))
        settings = {**self.state.settings.get(technique, {}), **(more or {})}
        return lambda: BackgroundRenderer(
            scene, technique, size, settings=settings, adapter=adapter
        )

    def _take_made(self) -> None:
        """The renderer that was being made; where it was refused, the one before stays."""
        self._refused, state = self._making.wanted, self.state
        try:
            self._made, drawn = self._making.take()
        except Exception as error:  # a driver's refusal must not take the window down
            state.message, state.notice = said(error), ""
            return
        # The new renderer takes the place of the one before.
        if self._drawn:
            self._drawn.close()
        self._drawn, self._refused, state.message = drawn, None, ""
        if self._made == PREVIEW:
            return
        self.quality.samples = COARSER_SAMPLES if self._finer() else STILL_SAMPLES
        self._say_made()

    def _say_made(self) -> None:
        if self.state.notice in MAKING:
            self.state.notice = ""

    def _moving(self) -> dict[str, Any]:
        """What frames of a view that moves have beside the settings.

        On quick devices they gather. Where they do, they go on from those before them. Neither
        where someone says otherwise.
        """
        state = self.state
        now = checked_settings(state.technique, state.scene, state.chosen_settings)
        # What was said by a person or by the file is left as it is.
        told = {**state.scene.settings.get(state.technique, {}), **state.chosen_settings}
        gather, more = getattr(now, "gather", ""), dict[str, Any]()
        if self._gathers_moving and gather == "still" and "gather" not in told:
            gather = more["gather"] = "always"
        if gather == "always" and "gather_history" not in told:
            more["gather_history"] = GATHER_HISTORY
        return more

    def _judge_moving(self) -> None:
        """Where moving frames became coarse to stay quick, they gather no more, and are fine."""
        if self._gathers_moving and self.quality.scale > 1.0 and self._moving().get("gather"):
            self._gathers_moving, self.quality.scale = False, 1.0
            self._made = None  # the renderer is made again behind the one that is seen

    def _finer(self, technique: str = "") -> dict[str, Any]:
        """What would make the image of a still view finer, of a technique or of the chosen one."""
        state = self.state
        name = technique or state.technique
        now = checked_settings(name, state.scene, state.settings.get(name, {}))
        return finer_settings(now, state.scene, is_cpu=self.gpu.is_cpu)

    @property
    def _is_refined(self) -> bool:
        """Whether a finer image follows: where it would be another one, or the view is coarse."""
        return self.quality.samples == COARSER_SAMPLES or self.quality.is_coarse

    def _refine(self) -> None:
        """Begin the finer image: the view is static, and its coarser image is done."""
        if not self._is_refined or self._made != self.wanted:
            return
        if self.fine.is_shown and self._is_compared_awaited:
            self.fine.hold()
            return
        assert self._drawn is not None
        technique = self._drawn.renderer.technique
        if self._finest_of is not technique:
            self.fine, self._finest_of = self._emptied(self.fine), technique
        self._drawn.finish(self.scene_now())
        solver = technique.find(GatherSolver)
        gathers = solver is not None and solver.settings.gather == "always"
        # What is seen now, which the finer image has to be better than.
        q = self.quality
        seen = Seen(q.full_samples, is_refined=not q.is_coarse, gathers=gathers)
        self.fine.begin(self._finest(self._drawn.renderer), self._shot_now(), seen)

    def _finest(self, live: Renderer) -> Callable[[], Renderer]:
        """Makes what draws the finest image: a view of what `live` has solved, where that will do,
        else a renderer with a finer solution."""
        state, size, finer = self.state, self._size, self._finer()
        if not can_show(live, finer):
            return self._maker(size, state.technique, finer)
        # As a still's settings are, not as those of a view that moves.
        now = checked_settings(state.technique, state.scene, {**state.chosen_settings, **finer})
        return lambda: SecondView(live, size, settings_of_views(now))

    def _compare(self) -> None:
        """Go on with the other technique's image of the static view, as fine as the own one.

        The own image comes first at full resolution, then the other one, then they take turns.
        """
        name, fine = self.state.compared, self.fine
        if name != self._compared_is:
            self.compared, self._compared_is = self._emptied(self.compared), name
        if not name:
            return
        is_refining = self._is_refined and not fine.message
        is_coarse = is_refining and self.quality.is_coarse and not fine.is_shown
        is_ahead = fine.is_working and self.compared.samples >= fine.samples + _LEAD
        if is_coarse or is_ahead:
            self.compared.hold()
        else:
            make = self._maker(self._size, name, self._finer(name))
            self.compared.begin(make, self._shot_now())

    @property
    def _is_compared_awaited(self) -> bool:
        """Whether the other technique's image has nothing to show, and will have."""
        other = self.compared
        is_done = bool(other.samples or other.message) or other.has_ended
        return bool(self.state.compared) and not is_done

    @property
    def compared_status(self) -> str:
        """How far the other technique's image is; empty without one."""
        if not self.state.compared or self._shot is None:
            return ""
        if self.compared.samples:
            return f"{self.compared.samples} of {SAMPLES}"
        return self.compared.progress or self.compared.message or "follows"

    @property
    def compared_names(self) -> tuple[str, str]:
        """What both techniques are called; of `auto` what it has chosen, too."""
        state = self.state
        own = self.renderer.technique.name if self.renderer else ""
        pairs = (state.technique, own), (state.compared, self.compared.technique)
        left, right = (f"auto: {is_}" if name == "auto" else name for name, is_ in pairs)
        return left, right

    def _shot_now(self) -> Shot:
        """The static view that other renderers draw: the same until something moves."""
        if self._shot is None:
            look, format = self.state.look, self._shown.format
            self._shot = Shot(self.scene_now(), self._size, look, format)
        return self._shot
