"""Techniques rendered and scored against the reference of one scene."""

from __future__ import annotations

import platform
import shlex
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ... import __version__
from ...errors import AirlightError
from ..options import shared_settings

if TYPE_CHECKING:
    from ...reference.metrics import EqualTime
    from ...scene.image import Image
    from ...scene.scene import Scene
    from ..progress import Report
    from .reference import Reference
    from .result import Comparison, Outcome


USUAL_PX = (640, 360)


@dataclass(frozen=True)
class Plan:
    """What a comparison is made with, as the options of `airlight compare` say.

    `settings` go to each technique that has them; `noise`: relative MSE that the reference's noise
    is to be below; `model` says how a mesh file was read (up, scale, variant).
    """

    size: tuple[int, int] = USUAL_PX
    spp: int = 64
    noise: float | None = None
    timeout_s: float = 3600.0
    samples: int = 16
    settings: Mapping[str, str] = field(default_factory=dict)
    adapter: str = "auto"
    model: Mapping[str, Any] = field(default_factory=dict)


def compare_scene(
    scene: Scene,
    label: str,
    techniques: tuple[str, ...],
    plan: Plan,
    *,
    output: Path,
    report: Report = lambda stage, fraction: None,
) -> Comparison:
    """Render the reference, then each technique, and score them.

    `label` is what the scene is called on a command line. A technique that fails is an outcome with
    its error. Raises ReferenceFailure, and SettingsError for a setting that no technique has or
    that cannot be.
    """
    from ...maths.tone import auto_exposure
    from .reference import reference_for
    from .result import Comparison

    # The reference first: its noise is the floor under every score.
    own = shared_settings(techniques, scene, plan.settings)
    reference = reference_for(
        scene, plan.size, plan.spp, noise=plan.noise, timeout_s=plan.timeout_s, report=report
    )
    # Each technique by itself: one that fails does not cost the others their page.
    outcomes = []
    for index, name in enumerate(techniques):
        report(f"rendering {name}", index / len(techniques))
        outcomes.append(_outcome(scene, label, name, replace(plan, settings=own[name]), reference))
    return Comparison(
        scene=label,
        command=_compare_command(label, techniques, output, plan),
        size=plan.size,
        samples=plan.samples,
        stops=auto_exposure(reference.image.radiance),
        reference=reference,
        outcomes=tuple(outcomes),
        about=_about(outcomes),
    )


def _outcome(
    scene: Scene,
    label: str,
    name: str,
    plan: Plan,
    reference: Reference,
) -> Outcome:
    """One technique rendered and scored, with the settings of `plan`; errors are its own."""
    from ...reference.metrics import compare
    from .result import Outcome

    # The command that draws this image again, shown beside it.
    words = ["airlight", "render", label, "-o", f"{name}.exr", "--layers", "--technique", name]
    words += ["--size", _size_word(plan.size), "--samples", str(plan.samples)]
    made = shlex.join([*words, *_own_words(plan)])
    try:
        image, taken_s = render_technique(
            scene, name, plan.size, plan.samples, plan.adapter, plan.settings
        )
        metrics = compare(image, reference.image)
    except AirlightError as error:
        return Outcome(name, made, error=str(error))
    except Exception as error:  # one broken technique must not cost the others their page
        return Outcome(name, made, error=f"internal error: {type(error).__name__}: {error}")
    # Beside the error, how long a path tracer takes to the same error.
    l2, floor_l2 = metrics.relative_l2 or 0.0, metrics.noise_floor_l2 or 0.0
    return Outcome(
        name,
        made,
        image,
        metrics,
        equal_time=_in_equal_time(metrics.relmse, reference.floor, taken_s, reference),
        equal_time_l2=_in_equal_time(l2**2, floor_l2**2, taken_s, reference),
        seconds=taken_s,
    )


def _in_equal_time(error: float, floor: float, taken_s: float, reference: Reference) -> EqualTime:
    from ...reference.metrics import equal_time

    return equal_time(
        error,
        taken_s,
        floor=floor,
        samples=reference.spp,
        reference_seconds=reference.seconds,
    )


def render_technique(
    scene: Scene,
    technique: str,
    size: tuple[int, int],
    samples: int,
    adapter: str = "auto",
    settings: Mapping[str, Any] | None = None,
) -> tuple[Image, float]:
    """The image and the seconds it took once shaders were compiled and textures loaded.

    Its layer one_bounce, where the technique can leave later bounces out, is the indirect light of
    another one.
    """
    from ...rendering import Renderer

    settings = settings or {}
    # The first frame compiles and solves, the second is what a frame costs.
    with Renderer(scene, technique, size, adapter=adapter, settings=settings) as renderer:
        renderer.frame(read=False)
        started_s = time.perf_counter()
        image = renderer.frame(samples=samples)
        taken_s = time.perf_counter() - started_s
    assert image is not None
    # One bounce has a reference of its own, so it is drawn by itself.
    if _has_bounces(technique, scene):
        once = {**settings, "bounces": False}
        with Renderer(scene, technique, size, adapter=adapter, settings=once) as renderer:
            bounced = renderer.frame(samples=samples)
        assert bounced is not None
        layers = {**image.layers, "one_bounce": bounced.layers["indirect"]}
        image = replace(image, layers=layers)
    return image, taken_s


def _has_bounces(technique: str, scene: Scene) -> bool:
    from ...techniques import settings_class

    return "bounces" in settings_class(technique, scene).__dataclass_fields__


def _compare_command(label: str, techniques: tuple[str, ...], output: Path, plan: Plan) -> str:
    # The words that made the comparison, so that the page says how to repeat it.
    words = ["airlight", "compare", label, "--technique", *techniques, "-o", str(output)]
    words += ["--size", _size_word(plan.size), "--spp", str(plan.spp)]
    words += ["--samples", str(plan.samples), *_own_words(plan)]
    return shlex.join(words + ([] if plan.noise is None else ["--noise", f"{plan.noise:g}"]))


def _size_word(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"


def _own_words(plan: Plan) -> list[str]:
    settings = [w for key, value in plan.settings.items() for w in ("-D", f"{key}={value}")]
    return settings + [w for key, value in plan.model.items() for w in _option(key, value)]


def _about(outcomes: list[Outcome]) -> dict[str, str]:
    # The device as any technique that worked has named it.
    stats = next((o.image.stats for o in outcomes if o.image is not None), {})
    about = {"airlight": __version__, "machine": f"{platform.system()} {platform.machine()}"}
    return about | ({"device": str(stats["device"])} if "device" in stats else {})


def _option(key: str, value: Any) -> tuple[str, ...]:
    """A keyword of `load` as its option; None is what it is without one."""
    if value is None:
        return ()
    if isinstance(value, bool):
        return (f"--{key}",) if value else (f"--no-{key}",)
    return f"--{key}", str(value)
