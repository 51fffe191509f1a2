"""Options that several commands share, and how their text is read."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import env

if TYPE_CHECKING:
    from ..maths.lut import Lut
    from ..scene.image import Image
    from ..scene.scene import Scene

LARGEST_SIDE_PX = 16384
LONGEST_S = 1e9


class Number(click.FloatRange):
    """A finite number in a range. click's own takes NaN, which is in every range."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value!r} is not a finite number", param, ctx)
        return number


AUTO = "auto"
"""Of --exposure: from the image itself."""


class Stops(Number):
    """An exposure in stops, or `AUTO`."""

    def convert(  # type: ignore[override]
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float | str:
        return AUTO if value == AUTO else super().convert(value, param, ctx)


class Seconds(click.types.FloatParamType):
    """A time in seconds, within thirty years of zero."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        seconds = float(super().convert(value, param, ctx))
        if not abs(seconds) <= LONGEST_S:  # NaN is not
            self.fail(f"{value!r} is not a time between -{LONGEST_S:g} and {LONGEST_S:g} s")
        return seconds


SECONDS = Seconds()

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def together(*options: Decorator) -> Decorator:
    """Several options as one decorator; `--help` lists them in this order."""

    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        # The last decorator is the first that `--help` lists.
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


def output_option(metavar: str, help: str, *, is_required: bool = True) -> Decorator:
    """-o, given to the command as `output`, a path; None where it need not be given and is not."""
    return click.option(
        "-o",
        "--output",
        required=is_required,
        type=click.Path(path_type=Path),
        metavar=metavar,
        help=help,
    )


def quiet_option() -> Decorator:
    """-q, given to the command as `quiet`."""
    return click.option("-q", "--quiet", is_flag=True, help="No progress.")


def solving_options(
    technique_help: str = "auto, direct, single, lpv, lpv-march, lpv-sum, lpv-scatter or pop.",
) -> Decorator:
    """-t, -D and --adapter: how the light in a scene is solved, and on which device."""
    return together(
        click.option("-t", "--technique", default="auto", show_default=True, help=technique_help),
        settings_option(),
        adapter_option(),
    )


def samples_option(default: int | None, help: str = "Jittered samples per pixel.") -> Decorator:
    """--samples N; None where it has no default and is not given."""
    return click.option(
        "--samples",
        type=click.IntRange(1, 4096),
        default=default,
        show_default=default is not None,
        help=help,
    )


def display_options(
    exposure_help: str = "Instead of the camera's; auto: from the image itself.",
    curve_help: str = "Display curve.  [default: agx]",
) -> Decorator:
    """--exposure, --tone-map, --lut, given as `exposure`, `tone_map` and `lut`, None without.

    `exposure` is a number of stops or `AUTO`.
    """
    return together(
        click.option("--exposure", type=Stops(-64, 64), metavar="STOPS|auto", help=exposure_help),
        click.option(
            "--tone-map", type=click.Choice(["agx", "aces", "neutral", "none"]), help=curve_help
        ),
        click.option(
            "--lut",
            metavar="FILE",
            callback=_lut,
            help="A .cube table of colours, looked up after the curve (.png, .jpg, videos).",
        ),
    )


def displayed(image: Image, options: Mapping[str, Any]) -> Image:
    """The image with the exposure, curve and table that `display_options` ask for."""
    names = {"exposure": "exposure_stops", "tone_map": "tone_map", "lut": "lut"}
    shown = {of: options[name] for name, of in names.items() if options[name] is not None}
    if options["exposure"] == AUTO:
        from ..maths.tone import auto_exposure

        shown["exposure_stops"] = float(auto_exposure(image.radiance))
    return replace(image, **shown)


def display_doubts(suffix: str, options: Mapping[str, Any]) -> list[str]:
    """What of `display_options` has no effect on files that end in `suffix`, as warnings.

    An .exr carries the exposure and the curve for others who display it, an .hdr nothing.
    """
    unused = {".exr": ("lut",), ".hdr": ("exposure", "tone_map", "lut")}.get(suffix.lower(), ())
    names = [f"--{name.replace('_', '-')}" for name in unused if options[name] is not None]
    return [f"{name} does nothing to an {suffix} file, which is linear" for name in names]


def _lut(_: click.Context, __: click.Parameter, value: str | None) -> Lut | None:
    from ..scene.io.cube import read_cube

    return None if value is None else read_cube(Path(value))


def size_option(usual: str = "those of the file's film; or 1280x720") -> Decorator:
    """--size WxH, given to the command as (width, height) in pixels, None where it is not given.

    `usual` says which size the command takes then.
    """
    help = f"Pixels.  [default: {usual}]"
    return click.option("--size", default=None, metavar="WxH", callback=_size, help=help)


def adapter_option() -> Decorator:
    """--adapter NAME; AIRLIGHT_ADAPTER where it is not given."""
    return click.option(
        "--adapter",
        default=lambda: env.value("AIRLIGHT_ADAPTER"),
        metavar="NAME",
        help="auto, cpu, gpu or a part of the adapter's name.  [default: auto]",
    )


def settings_option(help: str = "A setting of the technique; may be repeated.") -> Decorator:
    """-D KEY=VALUE, repeatable, given to the command as `settings`, {key: text}."""
    return click.option(
        "-D",
        "settings",
        multiple=True,
        metavar="KEY=VALUE",
        callback=_settings,
        help=help,
    )


def check_settings(technique: str, settings: Mapping[str, str]) -> None:
    """Refuse, before a scene is loaded, what the technique takes for none. Raises SettingsError."""
    from ..scene.scene import Scene
    from ..techniques import checked_settings

    if technique != "auto":  # its settings depend on the scene
        checked_settings(technique, Scene(), settings)


def shared_settings(
    techniques: Iterable[str], scene: Scene, settings: Mapping[str, str]
) -> dict[str, dict[str, str]]:
    """By technique, what of `settings` it has; nothing of one that there is not.

    Raises SettingsError for a setting that none of them has, and for a value that cannot be.
    """
    from ..errors import SettingsError, nearest
    from ..scene.settings import make_settings
    from ..techniques import settings_class

    own: dict[str, dict[str, str]] = {}
    known: set[str] = set()
    # A setting goes to the techniques that have it, checked by each.
    for name in techniques:
        try:
            made = settings_class(name, scene)
        except SettingsError:  # who renders with it says so
            own[name] = {}
            continue
        known |= made.__dataclass_fields__.keys()
        own[name] = {k: v for k, v in settings.items() if k in made.__dataclass_fields__}
        make_settings(made, own[name], where=f"technique {name}")
    # A setting that no technique has is a slip, and the nearest name is offered.
    unknown = [key for key in settings if known and key not in known]
    if unknown:
        raise SettingsError(
            f"unknown setting '{unknown[0]}'",
            where=f"techniques {', '.join(own)}",
            remedy=nearest(unknown[0], known),
        )
    return own


def _size(ctx: click.Context, param: click.Parameter, text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    parts = text.lower().split("x")
    if len(parts) != 2 or not all(part.isascii() and part.isdigit() for part in parts):
        raise click.BadParameter(f"'{text}' is not a size such as 1280x720")
    width_px, height_px = (int(part[:9]) for part in parts)
    if not (1 <= width_px <= LARGEST_SIDE_PX and 1 <= height_px <= LARGEST_SIDE_PX):
        raise click.BadParameter(f"'{text}' is outside 1x1 to {LARGEST_SIDE_PX}x{LARGEST_SIDE_PX}")
    return width_px, height_px


def _settings(ctx: click.Context, param: click.Parameter, texts: tuple[str, ...]) -> dict[str, str]:
    """The last value of a key holds; dashes in a key count as underscores."""
    return {key.replace("-", "_"): value for key, value in pairs(texts, "key=value")}


def pairs(texts: Iterable[str], form: str) -> Iterator[tuple[str, str]]:
    """What stands on both sides of the first = of each text. `form`: how a message writes one."""
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise click.BadParameter(f"'{text}' is not written as {form}")
        yield name.strip(), value.strip()
