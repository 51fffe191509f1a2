"""What of a session is on its surface: the mean of samples, the finest image, or two beside each
other.
"""

from __future__ import annotations

from typing import Any

from ...display.presenter import Look, Presenter
from ...display.show import Place
from ...gpu.commands import Commands
from ...gpu.device import Gpu
from .drawn import Drawn
from .fine import Fine

_COMPARED_FROM = 1  # samples


class Shown:
    """`take` samples, then `show`. `toned` is the image that was tone mapped last.

    `is_divided`: whether another technique's image was beside it.
    """

    def __init__(self, gpu: Gpu) -> None:
        self.gpu, self.format = gpu, ""
        self.toned: tuple[Any, ...] = ()
        self._other: tuple[Any, ...] = ()
        self._presenter: Presenter | None = None
        self._is_settled, self.is_divided = True, False

    def attach(self, format: str) -> None:
        """The surface's textures have this format."""
        if format != self.format:
            self.format = format
            self.release()

    def take(self, drawn: Drawn, look: Look, sample: int, *, settled: bool) -> None:
        """A drawn sample into the mean of its image, which 0 begins."""
        r, commands = drawn.renderer, drawn.renderer.commands
        if self._presenter is None:
            self._presenter = Presenter(self.gpu, r.size, self.format)
        self._presenter.resize(r.size)
        self._presenter.take(commands, r.technique.layers(r.view), r.view, look, sample)
        self._tone(self._presenter, commands, look, sample, settled=settled)

    def show(
        self,
        commands: Commands,
        target: Any,
        place: Place | None,
        fine: Fine,
        compared: tuple[Fine, float] | None,
        look: Look,
        *,
        is_at_rest: bool = True,
    ) -> None:
        """The best image that there is, onto `target`; at rest its exposure is settled."""
        # The finer image, where it is better than the samples here.
        shown, samples = fine.shown if fine.is_shown else (self._presenter, 0)
        if shown is None:
            return
        samples = samples or self.toned[1]
        # Tone mapped again where image, samples or look have changed, or the exposure moved.
        if self.toned != (shown, samples, look) or (is_at_rest and not self._is_settled):
            self._tone(shown, commands, look, samples, settled=True)
            self._other = ()
        beside = compared and self._beside(commands, *compared, look, shown)
        self.is_divided = beside is not None
        shown.show(commands, target, place, beside)
        commands.submit()

    def is_behind(self, fine: Fine) -> bool:
        """Whether the finest image has samples that are not on the surface."""
        return fine.is_shown and self.toned[:2] != fine.shown

    def is_behind_other(self, other: Fine) -> bool:
        """The same of the compared image."""
        return other.samples >= _COMPARED_FROM and self._other[:2] != (
            other.presenter,
            other.samples,
        )

    def release(self) -> None:
        """Give the device's memory back."""
        if self._presenter:
            self._presenter.release()
        self._presenter, self.toned, self._other = None, (), ()

    def _beside(
        self, commands: Commands, other: Fine, split: float, look: Look, shown: Presenter
    ) -> tuple[Presenter, float] | None:
        """The compared technique's image, exposed as the other one, once it has a sample."""
        presenter = other.presenter
        if presenter is None or other.samples < _COMPARED_FROM:
            return None
        # The other image has the first one's exposure, so that both can be compared.
        now = (presenter, other.samples, look)
        if self._other != now:
            presenter.tone(commands, look, exposed_as=shown)
            self._other = now
        return presenter, split

    def _tone(
        self, presenter: Presenter, commands: Commands, look: Look, samples: int, *, settled: bool
    ) -> None:
        presenter.tone(commands, look, settled=settled)
        commands.submit()
        self.toned, self._is_settled = (presenter, samples, look), settled
