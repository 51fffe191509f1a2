"""The finest image of a still view: media at full resolution, a larger sky lattice.

A renderer of its own is created, solved and drawn in the background; a presenter of its own
averages its samples. It is shown once its mean is better than what is seen, and the other one again
as soon as anything moves. A camera that moved costs it new samples only, a light that moved a new
solution. Where the other one is coarse, plain samples come first, which are quick: nothing is
gathered.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...display.presenter import Look, Presenter
from ...errors import DeviceError
from ...gather.solver import GatherSolver
from ...gpu.device import Gpu
from ...gpu.sliced import SlicedCommands
from ...maths.sampling import pixel_jitter
from ...rendering import Renderer
from ...scene.lens import through_lens
from ...scene.scene import Scene
from .build import Task, Turns, said
from .drawn import Drawn

SAMPLES = 64
SHOWN_FROM = 8
"""Samples of another image of full size are given up for no fewer of the finer one."""
GATHERED_FROM = 1
"""But where those gather and the others do not, for so many: each is of two images.

Living room at 240x135, RMSE of tone mapped values beside 24 gathered samples: .036 for one of them,
.026 for two; .055, .050 and .048 for 2, 8 and 16 plain ones. Those had 16 rays; in `builtin:room`
two samples have .023 with 16 and .026 with 8, 16 plain ones .039."""
PLAIN_SAMPLES = 2
"""Drawn at full size before gathered ones, and shown at once in place of a coarse image.

The RMSE of the living room, as above, is .055 for two of them and .050 for four."""
MOST_BYTES = 512 << 20
"""Of the device, beside what the coarser renderer has; where it takes more it is given up."""


@dataclass(frozen=True, eq=False)
class Shot:
    """What a finest image is of."""

    scene: Scene
    size: tuple[int, int]
    look: Look
    format: str


@dataclass(frozen=True)
class Seen:
    """The image that is shown until the finest one is better.

    `samples` of its size, whether somebody refines them (`is_refined`), whether they gather.
    """

    samples: int = 0
    is_refined: bool = True
    gathers: bool = False


class Fine:
    """`begin` where the view is static, `moved` when it no longer is; for one structure.

    `samples` are in the mean of `presenter`, `plain` in that of plain ones. `message`: why there
    will be none.
    """

    def __init__(self, gpu: Gpu, turns: Turns) -> None:
        self.gpu, self._turns = gpu, turns
        # Two means, of gathered and of plain samples, and from when on each is better.
        self.samples, self.plain, self.message = 0, 0, ""
        self._from = SHOWN_FROM
        self._given_up = 0
        self.presenter: Presenter | None = None
        self._plain_presenter: Presenter | None = None
        self._drawn: Drawn | None = None
        self._task: Task[None] | None = None
        self._shot: Shot | None = None

    @property
    def is_shown(self) -> bool:
        """Whether its mean is better than the coarser image's."""
        is_better = self.samples >= self._from or self.plain > self._given_up
        return self._shot is not None and is_better

    @property
    def shown(self) -> tuple[Presenter | None, int]:
        """What is to be seen of it, and the samples in that."""
        if self.samples >= self._from or not self.plain:
            return self.presenter, self.samples
        return self._plain_presenter, self.plain

    @property
    def is_empty(self) -> bool:
        """Whether nothing was made yet."""
        return self._task is None and self._drawn is None and not self.message

    @property
    def is_working(self) -> bool:
        """Whether something is being made, even if it is held."""
        return self._task is not None and not self._task.is_done

    @property
    def progress(self) -> str:
        """What is being done for its first gathered sample; empty once that is there."""
        is_awaited = self._shot is not None and self.is_working and not self.samples
        return self._task.progress if self._task and is_awaited else ""

    @property
    def has_ended(self) -> bool:
        """Whether what was being made is done, and `begin` has more to do or to say."""
        return self._task is not None and self._task.is_done

    @property
    def technique(self) -> str:
        """The name of its technique, once there is one."""
        return self._drawn.renderer.technique.name if self._drawn else ""

    @property
    def drawn(self) -> Drawn | None:
        """Its renderer, for who saves what is shown; only while nothing is being made."""
        return None if self.is_working else self._drawn

    def moved(self) -> None:
        """The view is no longer static: what is being made holds. Only in the viewer's turn."""
        self.samples, self.plain, self._shot = 0, 0, None
        self.hold()

    def hold(self) -> None:
        """Let another image go on first, until `begin`."""
        if self._task:
            self._task.pause(holds=True)

    def begin(self, make: Callable[[], Renderer], shot: Shot, seen: Seen = Seen()) -> None:
        """Go on towards the finest image of `shot`; `make` makes the renderer for it."""
        # One task at a time; it goes on where it was while the view is the same.
        if self._task and not self._task.is_done:
            self._task.pause(holds=False)
            return
        if self._task is not None:
            self._take()
        if self.message or (self._shot is shot and self.samples >= SAMPLES):
            return
        # A new view starts from nothing: its samples cannot be averaged with others.
        self._shot, self.samples, self.plain = shot, 0, 0
        self._from, self._given_up = SHOWN_FROM, seen.samples
        self._task = Task(
            self.gpu, self._turns, lambda commands: self._work(commands, make, shot, seen)
        )

    def halt(self) -> None:
        """Return once nothing is being made: at the end of the sample that is being drawn."""
        self._shot = None
        if self._task:
            self._task.wait()

    def retire(self) -> None:
        """`drop`, without waiting for it; nothing else may be asked of it from now on."""
        if self._task:
            self._task.stop()
        threading.Thread(target=self.drop, name="airlight viewer").start()

    def drop(self) -> None:
        """Give the device's memory back, once what is being made was broken off."""
        # The task is waited for, because it may be using what is released next.
        self._shot = None
        if self._task:
            self._task.stop()
            self._task.wait()
        if self._drawn:
            self._drawn.close()
        for presenter in (self.presenter, self._plain_presenter):
            if presenter:
                presenter.release()
        self._task = self._drawn = self.presenter = self._plain_presenter = None
        self.samples = self.plain = 0

    def _take(self) -> None:
        """The end of a task: an error of it ends the attempts."""
        assert self._task
        task, self._task = self._task, None
        try:
            task.result()
        except Exception as error:
            self.drop()
            self.message = f"no finer image: {said(error)}"

    def _work(
        self, commands: SlicedCommands, make: Callable[[], Renderer], shot: Shot, seen: Seen
    ) -> None:
        """In the task's thread: the renderer, the solution, then samples while `shot` is wanted."""
        # A finer renderer beside the live one must leave memory to it.
        if self._drawn is None:
            before = self.gpu.allocated_bytes
            self._drawn = Drawn(make())
            taken = self.gpu.allocated_bytes - before
            if taken > MOST_BYTES:
                raise DeviceError(f"it would take {taken >> 20} MiB of memory")
        # Light is solved once, as for an image of several samples.
        drawn = self._drawn
        drawn.give(shot.scene)
        drawn.renderer.resize(shot.size)
        drawn.renderer.view.is_still = True
        drawn.solve(commands, is_still=True)
        commands.wanted = lambda: self._shot is shot
        # Plain samples come first where nobody refines some of its size, and others are slow.
        plain = 0
        if not seen.gathers and drawn.renderer.technique.find(GatherSolver) is not None:
            has_plain = seen.is_refined or seen.samples >= PLAIN_SAMPLES
            self._from, plain = GATHERED_FROM, 0 if has_plain else PLAIN_SAMPLES
        elif not seen.is_refined:
            self._from = seen.samples + 1
        # Samples are folded in one by one, until what is looked at is another shot.
        stages = [(True, index) for index in range(plain)]
        for is_plain, index in stages + [(False, index) for index in range(SAMPLES)]:
            if self._shot is not shot:
                return
            # Plain samples do not gather; images of one that does share what was gathered.
            drawn.renderer.view.may_gather = not is_plain
            count = 1 if is_plain else drawn.renderer.technique.jitters(SAMPLES)
            for image, offset in enumerate(sample_jitters(SAMPLES, count)[index]):
                camera, at = through_lens(shot.scene.camera, offset, index, shot.size[1])
                drawn.draw(commands, camera, at, index, (image, count))
                commands.submit()
                self._fold(commands, drawn.renderer, shot, index, (image, count), is_plain=is_plain)

    def _fold(
        self,
        commands: SlicedCommands,
        r: Renderer,
        shot: Shot,
        index: int,
        jitter: tuple[int, int],
        *,
        is_plain: bool,
    ) -> None:
        """The drawn image into the mean, in one turn: the viewer's thread shows the same mean."""
        with self._turns.behind():
            if self._shot is not shot:
                return
            # Each kind of samples has a mean of its own.
            presenter = self._plain_presenter if is_plain else self.presenter
            if presenter is None:
                presenter = Presenter(self.gpu, shot.size, shot.format)
            presenter.resize(shot.size)
            # The image joins the mean of those before it; a sample counts with its last one.
            image, count = jitter
            layers = r.technique.layers(r.view)
            presenter.take(commands, layers, r.view, shot.look, index * count + image)
            commands.submit()
            done = index + (image + 1 == count)
            if is_plain:
                self._plain_presenter, self.plain = presenter, done
            else:
                self.presenter, self.samples = presenter, done


@functools.cache
def sample_jitters(samples: int, count: int) -> tuple[tuple[tuple[float, float], ...], ...]:
    """Where in their pixels the `count` images of each sample lie; nearest to the middle first."""
    jitters = pixel_jitter(samples * count).reshape(samples, count, 2)
    # Gathers choose their points for the first, which is the nearest to pixels' middles.
    return tuple(
        tuple((float(x), float(y)) for x, y in sorted(sample, key=np.linalg.norm))
        for sample in jitters
    )
