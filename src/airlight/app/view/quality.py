"""How finely the next image is drawn: coarse while anything moves, finer and finer when still.

Resolution follows the time that frames really took, so that a machine without a GPU stays above
ten frames a second where it can, and answers as soon while it refines. A view at rest is never
coarser than it was while it moved. Where frames at full resolution take longer, it stays coarse
here, and a finer image in the background has the full resolution (`fine`); only where there can be
none is it drawn here, whatever it takes.
"""

from __future__ import annotations

from dataclasses import dataclass

SETTLE_S = 0.2
"""Nothing has moved for so long: time to refine."""
STILL_SAMPLES = 64
MOST_SCALE = 8.0
_SLOW_MS, _FAST_MS, _AIM_MS = 75.0, 35.0, 55.0
_SHARP_MS = 150.0  # that a hand may have to wait for an image of full size, of which two are drawn
_SAVES = 0.85  # of the time, at least: coarser images that take more are no answer
_COARSE_SAMPLES = 8  # of a view at rest that is not at full size
_PATIENCE = 6  # fast frames in a row before a finer one is tried
_STEPS = (1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.4, 8.0)


@dataclass(frozen=True)
class Plan:
    """The next image: its size in pixels, and its number among those averaged (0 restarts).

    `sample` None: nothing is left to do.
    """

    size: tuple[int, int]
    sample: int | None
    is_moving: bool = False


class Quality:
    """`plan` before each frame, `took` after it."""

    def __init__(self, *, is_cpu: bool, samples: int = STILL_SAMPLES) -> None:
        self.samples = samples
        self.scale = 2.0 if is_cpu else 1.0  # of a side, while moving
        self.still_scale = 0.0  # of a side, that views at rest can afford; 0: not known yet
        self.is_alone = False
        """Whether nobody else draws a view at rest at full size."""
        self._full = (0, 0)
        self._coarsest = MOST_SCALE
        self._finer: tuple[float, float] | None = None  # the scale before, and what it took, ms
        self._quick_frames = 0
        self._slow_ms = 0.0  # of the frame before, where that was slow
        self._moving_ms = _AIM_MS  # what the last moving image took
        self._changed_s = float("-inf")
        self._done = 0
        self._still_size = (0, 0)
        self._was_moving = True
        self._rest_size = (0, 0)  # of the view at rest: the same until it moves
        self._moving_size: tuple[int, int] | None = None  # of the last moving image
        self._is_last = False  # whether the view at rest is drawn at full size, whatever it takes
        self._is_slow = False  # whether it takes too long at the size that it is drawn at

    @property
    def share(self) -> float:
        """How much of the refinement is done, 0 to 1; 1 only where it is at its end."""
        done = self._done / self._wanted
        # A coarse view that nobody else draws at full size is half done at most.
        return 0.5 * done if self.is_alone and self.is_coarse else done

    @property
    def is_coarse(self) -> bool:
        """Whether the view at rest is not drawn at full size, or not refined there."""
        return self._still_size != self._full or self._is_slow

    @property
    def full_samples(self) -> int:
        """How many samples of full size the view at rest has."""
        return self._done if self._still_size == self._full else 0

    @property
    def is_done(self) -> bool:
        """Whether a view at rest has all samples that it gets here."""
        return self.share >= 1.0

    @property
    def _wanted(self) -> int:
        """How many samples the view at rest gets, at its size."""
        if self._is_slow:
            return max(1, self._done)
        return min(self.samples, _COARSE_SAMPLES) if self.is_coarse else self.samples

    def coarse(self, full: tuple[int, int]) -> tuple[int, int]:
        """The size of images while something moves."""
        return _reduced(full, self.scale)

    def plan(
        self,
        now_s: float,
        full: tuple[int, int],
        *,
        changed: bool,
        is_busy: bool = False,
        is_rough: bool = False,
    ) -> Plan:
        """What to draw at `now_s` on a surface of `full` pixels.

        `changed`: since the last. `is_busy`: a hand is at work, and must not wait for a fine
        image to be done before the next coarse one. `is_rough`: moving images lack something else
        than pixels.
        """
        # Another size: what was learnt about the time of frames no longer holds.
        if full != self._full:
            self._coarsest, self._finer = MOST_SCALE, None
            self._full, self._rest_size, self._moving_size = full, full, None
            self.still_scale, self._is_last, self._is_slow = 0.0, False, False
        if changed:
            self._changed_s = now_s
        # While something changes: coarse images, at most one for a change.
        if now_s - self._changed_s < SETTLE_S:
            self._was_moving, self._done, self._is_last = True, 0, False
            if changed:
                self._moving_size = self.coarse(full)
            return Plan(self.coarse(full), 0 if changed else None, is_moving=True)
        # At rest, as fine as is affordable.
        self._rest(full, is_busy=is_busy, is_rough=is_rough)
        full = self._rest_size
        # A hand at work keeps what is shown until it lets go.
        if is_busy and (self._was_moving or self._still_size == full):
            return Plan(full, None, is_moving=self._was_moving)
        # Another size starts its samples from the first; they end after `samples`.
        if self._was_moving or self._still_size != full:
            self._was_moving, self._still_size, self._done = False, full, 0
        if self._done >= self._wanted:
            return Plan(full, None)
        self._done += 1
        return Plan(full, self._done - 1)

    def _rest(self, full: tuple[int, int], *, is_busy: bool, is_rough: bool) -> None:
        """Find the size of images at rest: as fine as those have been affordable, and at last the
        `full` size where nobody else draws it."""
        if self._was_moving and not is_busy:
            # The machine may have time again.
            self.still_scale = _step_below(self.still_scale or self._guess())
            affordable = full if self._is_soon_sharp else _reduced(full, self.still_scale)
            self._rest_size = max(affordable, self._moving_size or self.coarse(full))
            self._is_last, self._is_slow = False, affordable < self._rest_size
            # What is too slow for a hand has one sample: the moving image that is seen.
            if self._is_slow and self._rest_size == self._moving_size and not is_rough:
                self._was_moving, self._still_size, self._done = False, self._rest_size, 1
            # So may coarser images save some, which others' work hid.
            self._coarsest, self._finer = MOST_SCALE, None
        if self.is_alone and self._done >= self._wanted and self.is_coarse and not is_busy:
            # Refinement does not end coarse.
            self._rest_size, self._is_last, self._is_slow = full, True, False
            self._done = self._done if self._done > 1 else 0  # it may be the moving image's

    def took(self, ms: float, plan: Plan) -> None:
        """A frame of `plan` took `ms`, with the device done."""
        if plan.is_moving:
            self._moving_ms = ms
        # One slow frame may be another program's doing, or a shader's first use.
        before, self._slow_ms = self._slow_ms, ms if ms > _SLOW_MS else 0.0
        # Stills that hold up the viewer twice end here; the next ones are coarser by as much as
        # they were late.
        if not plan.is_moving:
            if ms > _SLOW_MS and before and not self._is_last:
                share = (min(ms, before) / _AIM_MS) ** 0.5
                self.still_scale = _step_above(self._full[0] / max(plan.size[0], 1) * share)
                self._slow_ms, self._is_slow = 0.0, True
        # Moving frames that are slow twice coarsen those after them.
        elif ms > _SLOW_MS:
            self._quick_frames = 0
            if before:
                self._slow_ms = 0.0
                self._coarsen(min(ms, before))
        # Quick frames have to last before a finer one is tried.
        elif ms < _FAST_MS and self.scale > 1.0:
            self._quick_frames += 1
            if self._quick_frames >= _PATIENCE:
                self._quick_frames = 0
                self.scale = _step_below(self.scale)
        else:
            self._quick_frames = 0

    @property
    def _is_soon_sharp(self) -> bool:
        """Whether full size is worth two images, even slow ones: as if pixels were all that costs,
        by what the last moving image took."""
        return self.scale**2 * self._moving_ms <= _SHARP_MS

    def _guess(self) -> float:
        """A step above the scale of a view at rest that would take `_AIM_MS`, by what the last
        moving image took."""
        scale = self.scale * (self._moving_ms / _AIM_MS) ** 0.5
        return _STEPS[min(_STEPS.index(_step_above(min(scale, MOST_SCALE))) + 1, len(_STEPS) - 1)]

    def _coarsen(self, ms: float) -> None:
        """Moving images take `ms`: coarser ones, unless that has saved little the last time."""
        if self._finer and ms > _SAVES * self._finer[1]:
            self.scale = self._coarsest = self._finer[0]
            self._finer = None
            return
        self._finer = (self.scale, ms)
        self.scale = min(_step_above(self.scale * (ms / _AIM_MS) ** 0.5), self._coarsest)


def _reduced(full: tuple[int, int], scale: float) -> tuple[int, int]:
    return (max(1, round(full[0] / scale)), max(1, round(full[1] / scale)))


def _step_above(scale: float) -> float:
    return next((step for step in _STEPS if step >= scale), MOST_SCALE)


def _step_below(scale: float) -> float:
    return _STEPS[max(0, _STEPS.index(scale) - 1)]
