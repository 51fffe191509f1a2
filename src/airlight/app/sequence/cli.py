"""`airlight sequence`: a moving scene in, frames or a video out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ...errors import OutputError, SettingsError
from ..options import (
    AUTO,
    SECONDS,
    Number,
    check_settings,
    display_doubts,
    display_options,
    output_option,
    quiet_option,
    samples_option,
    size_option,
    solving_options,
    together,
)
from ..outputs import check_writable, is_folder
from ..scene_argument import load_scene, reads, show_warnings, warn
from ..scene_options import camera_options, scene_options, with_camera, with_exposure
from .folder import FrameFolder, sweep_video
from .plan import FORMATS, Plan, digest, frame_span
from .progress import counted
from .video import VIDEO_SUFFIXES, check_video, video_comment, write_video

if TYPE_CHECKING:
    from ...scene import Scene


_APART = ("resume", "farm")
"""Options by which frames are made without those before them."""
FRAME_OPTIONS = together(
    output_option("DIR|FILE.mp4", "A folder for frames, or a video."),
    solving_options(),
    size_option(),
    samples_option(6),
    scene_options(),
    click.option("--resume", is_flag=True, help="Go on where a run was broken off."),
    quiet_option(),
)
"""What every command takes that makes frames or a video of a scene; `plan_of` reads it."""


def frame_kind_options() -> Callable[[Any], Any]:
    """--format, --layers, --keep-frames: what a frame's file is."""
    return together(
        click.option(
            "--format",
            "kind",
            type=click.Choice(list(FORMATS)),
            help="Of frames: png is tone mapped, exr linear.  [default: png]",
        ),
        click.option("--layers", is_flag=True, help="Keep every layer in EXR frames."),
        click.option("--keep-frames", is_flag=True, help="Keep a video's frames beside it."),
    )


def shown_by(options: Mapping[str, Any]) -> dict[str, Any]:
    """Fields of a Plan that say how frames are shown and written, as options have them."""
    return {
        "ending": FORMATS[options["kind"] or "png"],
        "layers": options["layers"],
        "exposure_stops": None if options["exposure"] == AUTO else options["exposure"],
        "tone_map": options["tone_map"],
        "lut": options["lut"],
    }


@click.command("sequence")
@FRAME_OPTIONS
@click.option("--frames", metavar="N|A-B", help="How many, or which: 0-59.  [default: all]")
@click.option("--start", "start_s", type=SECONDS, metavar="SECONDS", help="The first frame's time.")
@click.option("--end", "end_s", type=SECONDS, metavar="SECONDS", help="When it ends.")
@click.option(
    "--fps",
    type=Number(1e-3, 1e4),
    help="Frames per second; --sequence-fps says how fast grids follow each other.",
)
@camera_options()
@display_options()
@frame_kind_options()
@click.option("--farm", metavar="tcp://HOST:PORT", help="Spread frames over a dask cluster.")
def command(scene: str, output: Path, **options: Any) -> None:
    """Render a moving SCENE into frames or a video.

    \b
    airlight sequence builtin:smoke -o smoke.mp4 --frames 60 --size 480x270
    airlight sequence plume/ -o plume.mp4            a folder of grids, or 'plume/*.vdb'
    airlight sequence flight.toml -o flight/ --format exr --layers
    airlight sequence flight.toml -o flight/ --resume --farm tcp://scheduler:8786

    Frames are numbered from 0; each appears whole or not at all, and shows the same whichever are
    made before it. What moves is said in the scene file, or by a glTF file's animation.
    """
    reads(scene)
    check_sequence(output, options)
    loaded = with_camera(load_scene(scene, options["model"]), options["camera"])
    loaded = with_exposure(loaded, options["exposure"])
    warn(display_doubts(FORMATS[options["kind"] or "png"], options))
    make_sequence(_plan(loaded, options), loaded, output, options)


def make_sequence(plan: Plan, loaded: Scene, output: Path, options: Mapping[str, Any]) -> None:
    """The plan's frames into a folder or a video, gone on with and spread as `options` say.

    `options` are `resume`, `farm`, `quiet` and `keep_frames`. Raises AirlightError.
    """
    from ...techniques import checked_settings

    is_video = output.suffix.lower() in VIDEO_SUFFIXES
    if is_video:
        check_writable(output)
    show_warnings(loaded)
    # Settings and options are checked together: some frames depend on those before them.
    made = checked_settings(plan.technique, loaded, plan.settings)
    _check_alone(plan, made, options)
    # A digest of all that the frames depend on marks the video, for runs that resume.
    asked = plan.asked(loaded)
    comment = f"airlight sequence {digest({**asked, 'frames': [plan.first, plan.last]})}"
    # A video's frames lie in a folder beside it until it is encoded.
    folder = FrameFolder(output.with_name(output.name + ".frames") if is_video else output)
    if is_video:
        sweep_video(output)
    # A video that says it is this one is done, but perhaps for the clearing up.
    if not (is_video and options["resume"] and video_comment(output) == comment):
        folder.open(asked, resume=options["resume"])
        make_frames(plan, loaded, folder, farm=options["farm"], quiet=options["quiet"])
        if is_video:
            _encode(plan, folder, output, comment, quiet=options["quiet"])
    # The frames of a finished video are only kept if asked for.
    if is_video and not options["keep_frames"]:
        folder.clear()
    click.echo(str(output))


def _check_alone(plan: Plan, made: Any, options: Mapping[str, Any]) -> None:
    """Refuse to make frames that go on from others apart from those; `made`: the settings."""
    count, asked = getattr(made, "gather_history", 0), [n for n in _APART if options[n]]
    if count and made.gather == "always" and plan.samples == 1 and asked:
        raise SettingsError(
            f"frames depend on those before them, as gather_history is {count}: --{asked[0]} would "
            "make others",
            remedy=f"Leave out --{asked[0]}, or set gather_history=0 or --samples 2.",
        )


def _encode(plan: Plan, folder: FrameFolder, output: Path, comment: str, *, quiet: bool) -> None:
    """The frames of `folder` as a video, marked by `comment`."""
    with counted("frames encoded", len(plan.frames), quiet=quiet) as count:
        files = [folder.file(plan, frame) for frame in plan.frames]
        write_video(files, plan.fps, output, comment, lambda share: count())


def make_frames(
    plan: Plan, scene: Scene, folder: FrameFolder, *, farm: str | None = None, quiet: bool = False
) -> None:
    """Make the plan's frames that the open `folder` lacks, here or on the cluster `farm`.

    Raises AirlightError; frames that were made stay.
    """
    from dataclasses import replace

    from .frames import FrameMaker, metered_stops

    # Frames that are there stay as they are.
    missing = folder.missing(plan)
    if not missing:
        return
    # One exposure for all: metered from the first frame, noted for runs that resume.
    if "metered_stops" not in folder.manifest:
        folder.note(metered_stops=metered_stops(plan, scene))
    if folder.metered_stops is not None:
        plan = replace(plan, exposure_stops=folder.metered_stops)
    # Here by one renderer, or each frame by a worker of the cluster.
    there = len(plan.frames) - len(missing)
    with _resumable(), counted("frames", len(plan.frames), there, quiet=quiet) as count:
        if farm is None:
            with closing(FrameMaker(plan, scene)) as maker:
                _note_device(folder, maker.renderer.gpu.info.name)
                for frame in missing:
                    maker.save(frame, folder.file(plan, frame))
                    count()
            warn(maker.doubts)
        else:
            _farmed(farm, plan, scene, folder, missing, count)


@contextmanager
def _resumable() -> Iterator[None]:
    """Whatever cannot be written says how to go on."""
    try:
        yield
    except OutputError as error:
        remedy = f"{error.remedy} What was made stays: --resume goes on.".lstrip()
        raise OutputError(error.problem, where=error.where, remedy=remedy) from None


def _farmed(
    address: str,
    plan: Plan,
    scene: Scene,
    folder: FrameFolder,
    missing: list[int],
    count: Callable[[], None],
) -> None:
    from ...scene.io.writing import whole_file
    from .farm import farm_frames

    doubts: dict[int, list[str]] = {}

    # A frame comes as the bytes of its file, and is there whole or not at all.
    def take(frame: int, data: bytes, device: str, said: list[str]) -> None:
        _note_device(folder, device)
        doubts[frame] = said
        with whole_file(folder.file(plan, frame)) as part:
            part.write_bytes(data)
        count()

    farm_frames(address, plan, scene, missing, take)
    warn([text for frame in missing for text in doubts[frame]])


def _note_device(folder: FrameFolder, device: str) -> None:
    """Keep which devices made frames, and say it where there are several."""
    # Devices round differently.
    devices = folder.manifest.get("devices", [])
    if device not in devices:
        folder.note(devices=[*devices, device])
        if devices:
            click.echo(
                f"warning: frames come from {' and '.join([*devices, device])}: they may differ "
                "in their last digits",
                err=True,
            )


def check_sequence(output: Path, options: Mapping[str, Any]) -> None:
    """Refuse, before any work, what could not be done after it."""
    is_video = output.suffix.lower() in VIDEO_SUFFIXES
    check_settings(options["technique"], options["settings"])
    if options["farm"]:
        from .farm import check_farm

        check_farm(options["farm"])
    # The output's ending decides: a video's needs its encoder, any other is a folder of frames.
    if is_video:
        if options["kind"] == "exr":
            raise SettingsError("a video has no EXR frames", remedy="Give a folder for frames.")
        check_writable(output, VIDEO_SUFFIXES)
        check_video()
    elif output.suffix and not is_folder(output):
        raise OutputError(
            f"'{output.suffix}' is no kind of video that is written here",
            where=output,
            remedy="End it in .mp4, or give a folder.",
        )
    # Layers have a place in EXR alone.
    if options["layers"] and options["kind"] != "exr":
        raise SettingsError("--layers needs --format exr")


def plan_of(scene: Scene, options: Mapping[str, Any], **frames: Any) -> Plan:
    """A plan as the command's `FRAME_OPTIONS` say; `frames` are its other fields."""
    shared = ("technique", "settings", "adapter", "samples")
    size = options["size"] or scene.camera.image_size
    return Plan(**{name: options[name] for name in shared}, size=size, **frames)


def _plan(scene: Scene, options: Mapping[str, Any]) -> Plan:
    start_s, fps, first, last = frame_span(
        scene, options["frames"], options["start_s"], options["end_s"], options["fps"]
    )
    return plan_of(
        scene,
        options,
        start_s=start_s,
        fps=fps,
        first=first,
        last=last,
        **shown_by(options),
    )
