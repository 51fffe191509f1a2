"""`airlight compare`: techniques against the unbiased reference, in numbers and images."""

from __future__ import annotations

import platform
import shlex
import time
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ... import __version__
from ...errors import AirlightError, SettingsError
from ..options import Number, adapter_option, settings_option, shared_settings, size_option
from ..outputs import check_outputs, make_folder, write_json
from ..progress import progress
from ..scene_argument import load_scene, reads, show_warnings, warn

if TYPE_CHECKING:
    from ...reference.metrics import EqualTime
    from ...scene.image import Image
    from ...scene.scene import Scene
    from ..progress import Report
    from .reference import Reference
    from .result import Comparison, Outcome

TECHNIQUE_OPTIONS = ("-t", "--technique")


@dataclass(frozen=True)
class Plan:
    """What a comparison is made with, as the options of `airlight compare` say.

    `settings` go to each technique that has them; `noise`: relative MSE that the reference's noise
    is to be below.
    """

    size: tuple[int, int] = (640, 360)
    spp: int = 64
    noise: float | None = None
    timeout_s: float = 3600.0
    samples: int = 16
    settings: Mapping[str, str] = field(default_factory=dict)
    adapter: str = "auto"


class _ManyTechniques(click.Command):
    """Lets `--technique a b c` name several, which click's options cannot."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        options = [p for p in self.params if isinstance(p, click.Option) and not p.is_flag]
        return super().parse_args(ctx, _one_each(args, {o for p in options for o in p.opts}))


def _one_each(args: list[str], valued: Collection[str]) -> list[str]:
    """`--technique a b` as `--technique a --technique b`; other arguments as they are.

    `valued` are the options that take a value. Where no other word could be SCENE, the last
    word of the last group is.
    """
    groups: list[list[str]] = []
    rest: list[str] = []
    has_scene = is_open = False
    for arg, before in zip(args, ["", *args], strict=False):
        if arg in TECHNIQUE_OPTIONS:
            groups.append([])
            is_open = True
        elif is_open and not arg.startswith("-"):
            groups[-1].append(arg)
        else:
            is_open = False
            rest.append(arg)
            has_scene |= not arg.startswith("-") and before not in valued
    if groups and len(groups[-1]) > 1 and not has_scene:
        rest.insert(0, groups[-1].pop())
    spread = [part for group in groups for name in group for part in ("--technique", name)]
    return rest + spread


@click.command("compare", cls=_ManyTechniques)
@click.argument("scene")
@click.option(
    "-t",
    "--technique",
    "techniques",
    multiple=True,
    metavar="NAME ...",
    help="Techniques to judge.  [default: direct auto]",
)
@click.option(
    "-o",
    "--output",
    required=True,
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Folder for index.html, contact_sheet.png and results.json.",
)
@size_option("640x360")
@click.option(
    "--spp",
    type=click.IntRange(4, 65536),
    default=64,
    show_default=True,
    help="Samples a pixel of the reference, at least.",
)
@click.option(
    "--noise",
    type=Number(0.0, min_open=True),
    metavar="RELMSE",
    help="Sample until the reference's noise floor is below this.",
)
@click.option(
    "--timeout",
    "timeout_s",
    type=Number(1.0),
    default=3600.0,
    show_default=True,
    help="Seconds the reference may take.",
)
@click.option(
    "--samples",
    type=click.IntRange(1, 4096),
    default=16,
    show_default=True,
    help="Jittered samples a pixel of each technique.",
)
@settings_option("A setting of each technique that has it; may be repeated.")
@adapter_option()
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def command(
    scene: str, techniques: tuple[str, ...], output: Path, quiet: bool, **options: Any
) -> None:
    """Judge techniques on SCENE by an unbiased reference.

    \b
    airlight compare builtin:cornell --technique direct lpv -o comparison/
    airlight compare builtin:cornell -t direct lpv -D resolution=48 -o finer/

    The reference comes from Mitsuba (pip install 'airlight[reference]') and is kept in the
    cache folder by the scene's content.
    """
    names = tuple(dict.fromkeys(techniques)) or ("direct", "auto")
    reads(scene)
    make_folder(output)
    check_outputs(*_files(output))
    with progress(quiet=quiet) as report:
        report("loading", 0.0)
        loaded = load_scene(scene)
        check_outputs(*_files(output))
        plan = Plan(**options)
        comparison = compare_scene(loaded, scene, names, plan, output=output, report=report)
        report("writing", 0.0)
        write(comparison, output)
    show_warnings(loaded)
    warn([text for text in [comparison.reference.not_cached] if text])
    _say(comparison, output)


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

    own = shared_settings(techniques, scene, plan.settings)
    reference = reference_for(
        scene, plan.size, plan.spp, noise=plan.noise, timeout_s=plan.timeout_s, report=report
    )
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

    words = ["airlight", "render", label, "-o", f"{name}.exr", "--layers", "--technique", name]
    words += ["--size", _size_word(plan.size), "--samples", str(plan.samples)]
    made = shlex.join([*words, *_settings_words(plan.settings)])
    try:
        image, taken_s = render_technique(
            scene, name, plan.size, plan.samples, plan.adapter, plan.settings
        )
        metrics = compare(image, reference.image)
    except AirlightError as error:
        return Outcome(name, made, error=str(error))
    except Exception as error:  # one broken technique must not cost the others their page
        return Outcome(name, made, error=f"internal error: {type(error).__name__}: {error}")
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
    with Renderer(scene, technique, size, adapter=adapter, settings=settings) as renderer:
        renderer.frame(read=False)
        started_s = time.perf_counter()
        image = renderer.frame(samples=samples)
        taken_s = time.perf_counter() - started_s
    assert image is not None
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


def write(comparison: Comparison, folder: Path) -> None:
    """index.html, contact_sheet.png and results.json, each whole or not at all."""
    from ...scene.io.writing import whole_file
    from .images import png_bytes
    from .page import page, sheet

    results, contact, index = _files(folder)
    write_json(comparison.to_json(), results)
    with whole_file(contact) as part:
        part.write_bytes(png_bytes(sheet(comparison)))
    with whole_file(index) as part:
        part.write_text(page(comparison), encoding="utf-8")


def _files(folder: Path) -> tuple[Path, Path, Path]:
    return folder / "results.json", folder / "contact_sheet.png", folder / "index.html"


def _compare_command(label: str, techniques: tuple[str, ...], output: Path, plan: Plan) -> str:
    words = ["airlight", "compare", label, "--technique", *techniques, "-o", str(output)]
    words += ["--size", _size_word(plan.size), "--spp", str(plan.spp)]
    words += ["--samples", str(plan.samples), *_settings_words(plan.settings)]
    return shlex.join(words + ([] if plan.noise is None else ["--noise", f"{plan.noise:g}"]))


def _size_word(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"


def _settings_words(settings: Mapping[str, str]) -> list[str]:
    return [word for key, value in settings.items() for word in ("-D", f"{key}={value}")]


def _about(outcomes: list[Outcome]) -> dict[str, str]:
    stats = next((o.image.stats for o in outcomes if o.image is not None), {})
    about = {"airlight": __version__, "machine": f"{platform.system()} {platform.machine()}"}
    return about | ({"device": str(stats["device"])} if "device" in stats else {})


def _say(comparison: Comparison, folder: Path) -> None:
    """The numbers on stdout, failures on stderr; SettingsError where no technique worked."""
    from .page import number

    for o in comparison.outcomes:
        if o.metrics is not None:
            m = o.metrics
            click.echo(
                f"{o.technique}: relmse {number(m.relmse)}, "
                f"energy {number(m.energy_ratio)}, flip {number(m.flip)}"
            )
        else:
            click.echo(f"warning: {o.technique} made no image: {o.error}", err=True)
    click.echo(str(folder / "index.html"))
    if all(o.error for o in comparison.outcomes):
        raise SettingsError("no technique made an image", where=folder / "index.html")
