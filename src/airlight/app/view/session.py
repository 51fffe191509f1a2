"""A viewer's session: it takes changes, draws the next image, and keeps the last good one."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ...display.presenter import layer_names
from ...display.show import Place
from ...errors import AirlightError
from ...maths.sampling import pixel_jitter
from ...scene.fingerprint import is_same
from ...scene.image import Image
from ...scene.lens import through_lens
from ...scene.scene import Scene
from .build import said
from .drawn import Drawn
from .fine import SAMPLES
from .quality import STILL_SAMPLES, Plan
from .renderers import COARSER_SAMPLES, MAKING, Renderers

_SAVED_SAMPLES = 16
_HAND_S = 0.25


class Session(Renderers):
    """`attach` it to a surface's format, then `frame` again and again.

    Raises SettingsError for an unknown technique or setting, DeviceError without a device; later
    errors become `state.message`.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        source: str = "",
        technique: str = "auto",
        settings: Mapping[str, Any] | None = None,
        adapter: str = "auto",
        model: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(scene, source, technique, settings, adapter, model)
        self.frame_ms, self.times_ms = 0.0, dict[str, float]()
        self._camera, self._time_s = scene.camera, 0.0
        self._jitters = pixel_jitter(STILL_SAMPLES)
        self._seen: tuple[Any, ...] = ()
        self._before_s: float | None = None
        self._progress = ("", "", "")
        self._touched_s = float("-inf")

    def attach(self, format: str) -> None:
        """The surface's textures have this format."""
        self._shown.attach(format)

    def touch(self, now_s: float) -> None:
        """A hand is at the mouse or the keys: fine images wait a moment."""
        self._touched_s = now_s

    @property
    def layers(self) -> tuple[str, ...]:
        """What can be looked at."""
        if self.renderer is None:
            return ("image",)
        return layer_names(self.renderer.technique.layers(self.renderer.view))

    def frame(
        self, target: Any, size: tuple[int, int], now_s: float, place: Place | None = None
    ) -> bool:
        """Draw an image of `size` pixels onto `target`; true where more frames are wanted.

        Where it is false, `has_news` tells when one is wanted again. `place`: of `target`, else the
        image fills it.
        """
        with self._turns.frame():
            self._size = size
            self._make()
            self._progress = self._awaited
            self.controls.height_px = size[1]
            # Time and hands first: keys that are held, and what turned the light.
            self._go_on(now_s)
            self.state.turn_light(self.controls.take_turn())
            is_busy = self.is_held or now_s - self._touched_s < _HAND_S
            if not is_busy:
                self.state.settle_sky()
                self.history.note(self.state)
            # An image that is soon another one needs no refinement: the new renderer needs time.
            is_busy |= self._making.is_under_way
            changed = self._has_changed()
            # Any change ends the refinement of what was looked at.
            if changed:
                self._shot = None
                self.fine.moved()
                self.compared.moved()
            self.quality.is_alone = bool(self.fine.message)
            is_rough = self._drawn is not None and self._drawn.is_quick
            plan = self.quality.plan(
                now_s, size, changed=changed, is_busy=is_busy, is_rough=is_rough
            )
            wants_more = self._drawn is not None and self._drew(plan)
            wants_more &= changed or not self._making.is_under_way
            self._show(target, place, is_at_rest=not plan.is_moving)
            is_waiting = self.state.notice in MAKING
            is_moving = self.controls.is_moving or self.state.is_playing
            return wants_more or is_moving or (is_waiting and not self._making.is_under_way)

    def _drew(self, plan: Plan) -> bool:
        """Draw what is planned, or let the finest image go on; true where more is wanted."""
        if plan.sample is not None:
            self._draw_or_say(plan)
        elif not plan.is_moving and self.quality.is_done:
            self._refine()
        if not plan.is_moving and self._made == self.wanted:
            self._compare()
        return plan.is_moving or plan.sample is not None or not self.quality.is_done

    @property
    def status(self) -> str:
        """In a few words: the last frame's time and size, or how far the finest image is, and the
        one beside it."""
        beside = self.compared_status
        return self._own_status + (f"   {self.state.compared}: {beside}" if beside else "")

    @property
    def is_divided(self) -> bool:
        """Whether two techniques' images are beside each other."""
        return self._shown.is_divided

    @property
    def _own_status(self) -> str:
        # How far the finer image is, else what the last frame took.
        if self._shot is not None and self.fine.is_working and not self.fine.samples:
            is_full = self.fine.is_shown or self.quality.full_samples > 0
            doing = "refining ..." if is_full else "full resolution follows ..."
            return f"{doing}   {self.fine.progress}".rstrip()
        if self.fine.is_shown or (self.fine.is_working and self._shot is not None):
            return f"refining   {self.fine.samples} of {SAMPLES}"
        width, height = self.renderer.size if self.renderer else self._size
        return f"{self.frame_ms:.0f} ms   {width} x {height}"

    @property
    def progress(self) -> str:
        """How far the renderer is that is being made; empty where none is."""
        return self._progress[0]

    @property
    def _awaited(self) -> tuple[str, str, str]:
        """How far the next renderer, the finer image and the compared one are."""
        return self._making.progress, self.fine.progress, self.compared.progress

    @property
    def share(self) -> float:
        """How much of the refinement is done, 0 to 1."""
        if not self._is_refined:
            return self.quality.share
        # Coarser and finer samples count alike.
        samples = self.quality.share * COARSER_SAMPLES + self.fine.samples
        return samples / (COARSER_SAMPLES + SAMPLES)

    def has_news(self) -> bool:
        """Whether something that was being made between frames is ready to be shown."""
        fine = self.fine
        is_finer = self._shown.is_behind(fine) or self._shown.is_behind_other(self.compared)
        is_further = self._awaited != self._progress
        has_ended = fine.has_ended or self.compared.has_ended
        return self._making.has_ended or has_ended or is_finer or is_further

    def _go_on(self, now_s: float) -> None:
        """What moves by itself: the camera by held keys, the scene by its time."""
        # Time passes only while something moves by itself.
        spent_s = 0.0 if self._before_s is None else now_s - self._before_s
        self.controls.advance(spent_s)
        state = self.state
        state.play(spent_s)
        goes_on = self.controls.is_moving or state.is_playing
        self._before_s = now_s if goes_on else None
        if state.time_s != self._time_s:
            self._time_s, before = state.time_s, self._camera
            self._camera = state.moved().camera
            if self._camera != before:  # the scene moves its camera; a hand may take it from there
                self.controls.camera = self._camera

    def prepare(self, size: tuple[int, int]) -> None:
        """Begin with the first image, of `size` until a frame says another."""
        self._size = size
        self._make()

    def image(self, samples: int = _SAVED_SAMPLES) -> Image:
        """What is seen now, at full size, with its layers. Raises AirlightError."""
        # The renderer of what is wanted now, which may still be in the making.
        self._make()
        self.wait()
        if self.state.message and self._made != self.wanted:
            raise AirlightError(self.state.message)
        # Where the finer solution is shown, it is what is saved.
        drawn = self._drawn
        assert drawn is not None
        if self.fine.is_shown:
            self.fine.halt()
            drawn.finish(self.scene_now())
            drawn = self.fine.drawn or drawn
        # Its samples replace those on screen, which begin again.
        with self._turns.frame():
            drawn.give(self.scene_now())
            drawn.renderer.resize(self._size)
            image = drawn.renderer.frame(samples=samples)
        assert image is not None
        self._seen = ()
        return replace(image, tone_map=self.state.look.curve)

    def close(self) -> None:
        """Give the device's memory back."""
        self._making.close()
        self.fine.drop()
        self.compared.drop()
        self._shown.release()
        if self._drawn:
            self._drawn.close()
        self._drawn = None

    def _has_changed(self) -> bool:
        # What the image depends on, by identity where it can be.
        s = self.state
        seen = (self.controls.camera, s.scene, self._made, s.look.layer, s.shows_times, s.time_s)
        now = (*seen, self._size)
        if is_same(now, self._seen):
            return False
        self._seen = now
        return True

    def _draw_or_say(self, plan: Plan) -> None:
        begin = time.perf_counter()
        try:
            self._draw(plan)
        except Exception as error:  # a driver's refusal must not take the window down
            self.state.message, self.state.notice = said(error), ""
        self.frame_ms = (time.perf_counter() - begin) * 1e3
        assert self._drawn
        # Solving costs the same at every resolution.
        self.quality.took(self.frame_ms - self._drawn.solve_ms, plan)
        if plan.is_moving:
            self._judge_moving()

    def _draw(self, plan: Plan) -> None:
        drawn = self._drawn
        assert drawn and plan.sample is not None
        r = drawn.renderer
        r.resize(plan.size)
        with r.used(), r.whole():
            self._draw_all(drawn, plan)

    def _draw_all(self, drawn: Drawn, plan: Plan) -> None:
        """The layers of one sample, and the image that they are part of."""
        assert plan.sample is not None
        r, commands = drawn.renderer, drawn.renderer.commands
        commands.is_timed, commands.stage_ms = self.state.shows_times, {}
        if self._made == self.wanted:
            drawn.give(self.scene_now())
        # Light that does not depend on the camera, then one jittered sample of the view.
        drawn.solve(commands, is_quick=plan.is_moving)
        x, y = (0.0, 0.0) if plan.is_moving else self._jitters[plan.sample]
        camera, place = self.controls.camera, (float(x), float(y))
        if not plan.is_moving:
            camera, place = through_lens(camera, place, plan.sample, plan.size[1])
        # Coarse images keep their samples of area lights, whose shadow maps no size makes quicker.
        drawn.draw(commands, camera, place, 0 if self.quality.is_coarse else plan.sample)
        # The sample joins the running mean, unless something moves.
        self._shown.take(drawn, self.state.look, plan.sample, settled=not plan.is_moving)
        r.gpu.wait()
        # Stages are read after the device is done.
        if commands.is_timed:
            if not r.gpu.is_cpu:
                commands.collect_timestamps()
            self.times_ms = dict(commands.stage_ms)
        commands.is_timed = False

    def _show(self, target: Any, place: Place | None, *, is_at_rest: bool) -> None:
        """The best image that there is, onto the surface."""
        if self._drawn is None:
            return
        state, commands = self.state, self._drawn.renderer.commands
        beside = (self.compared, state.split) if state.compared and self._shot else None
        self._shown.show(
            commands, target, place, self.fine, beside, state.look, is_at_rest=is_at_rest
        )
