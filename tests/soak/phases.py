"""Frames, renderers and resizes, each with the levels that were measured on the way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from airlight.rendering import Renderer
from airlight.techniques import TECHNIQUES

from .levels import Course, Level, level
from .moving import SETTINGS, moved, scene

MEASURED = 30
"""Levels taken in a phase, at most."""
SHAPES = ((1.0, 1.0), (1.5, 1.0), (1.0, 2.0), (2.0, 1.5))


@dataclass(frozen=True)
class Plan:
    """How long to soak, and at which size in pixels."""

    frames: int = 10_000
    renderers: int = 100
    resizes: int = 500
    size: tuple[int, int] = (64, 36)
    techniques: tuple[str, ...] = tuple(TECHNIQUES)
    slack: int = 0


def _course(
    name: str, count: int, plan: Plan, step: Callable[[int], None], now: Callable[[], Level]
) -> Course:
    """`count` steps after a tenth of them (at least three) to warm up, measured as they go."""
    warm = max(count // 10, 3)
    for k in range(warm):
        step(k)
    every = max(count // MEASURED, 1)
    levels = [now()]
    for k in range(1, count + 1):
        step(warm + k)
        if k % every == 0:
            levels.append(now())
    return Course(f"{name}, {count}", levels, plan.slack)


def frames(technique: str, plan: Plan) -> Course:
    """Frames of one renderer, in which everything moves."""
    settings = SETTINGS[technique]
    with Renderer(scene(), technique, plan.size, settings=settings) as renderer:

        def step(k: int) -> None:
            renderer.frame(**moved(k), read=k % 10 == 0)

        return _course(f"{technique}, frames", plan.frames, plan, step, lambda: level(renderer.gpu))


def renderers(plan: Plan) -> Course:
    """Renderers made, used and closed, the techniques one after the other."""
    techniques = plan.techniques
    held: list[Renderer] = []  # the last one, closed; its device is asked

    def step(k: int) -> None:
        for technique in (
            techniques if plan.renderers < len(techniques) else (techniques[k % len(techniques)],)
        ):
            settings = SETTINGS[technique]
            with Renderer(scene(), technique, plan.size, settings=settings) as renderer:
                renderer.frame(**moved(k))
            held[:] = [renderer]

    def now() -> Level:
        gpu = held[0].gpu
        held.clear()
        return level(gpu)

    return _course("renderers", plan.renderers, plan, step, now)


def resizes(plan: Plan) -> Course:
    """One renderer whose size changes before every frame, back to the first one in the end."""
    width, height = plan.size
    technique = "auto" if "auto" in plan.techniques else plan.techniques[0]
    with Renderer(scene(), technique, plan.size, settings=SETTINGS[technique]) as renderer:

        def step(k: int) -> None:
            for x, y in SHAPES[1:] if k % 2 else SHAPES[:0:-1]:
                renderer.resize((round(width * x), round(height * y)))
                renderer.frame(**moved(k), read=False)
            renderer.resize(plan.size)
            renderer.frame(**moved(k), samples=2)

        rounds = max(plan.resizes // len(SHAPES), 1)
        return _course("resizes, rounds", rounds, plan, step, lambda: level(renderer.gpu))
