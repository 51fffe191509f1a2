"""`airlight convert`: a scene to Mitsuba XML, GLB or a scene file; an image to another format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import OutputError, SettingsError
from .options import display_options, displayed
from .outputs import check_writable
from .scene_argument import load_scene, reads, show_warnings
from .scene_options import check_model, model_options

if TYPE_CHECKING:
    from ..maths.lut import Lut
    from ..scene import Scene

LINEAR_SUFFIXES = (".exr", ".hdr", ".pic", ".rgbe")
DISPLAY_SUFFIXES = (".png", ".jpg", ".jpeg")
IMAGES_OUT = (".exr", ".hdr", *DISPLAY_SUFFIXES)
SCENES_OUT = (".xml", ".glb", ".toml")


@click.command("convert")
@click.argument("source", metavar="IN")
@click.argument("target", metavar="OUT", type=click.Path(path_type=Path))
@display_options(
    "For .png and .jpg of a linear image; auto: from the image itself.  [default: 0]",
    "Display curve.  [default: agx of a linear image, none of an 8-bit one]",
)
@model_options()
def command(
    source: str,
    target: Path,
    exposure: float | str | None,
    tone_map: str | None,
    lut: Lut | None,
    model: dict[str, Any],
) -> None:
    """Convert a scene or an image.

    \b
    airlight convert room.toml room.xml     any scene to Mitsuba 3
    airlight convert room.toml room.glb     any scene's meshes, materials, lights and camera
    airlight convert room.glb room.toml     a scene file that names its meshes and grids
    airlight convert room.xml room.toml     Mitsuba's, its meshes in room_meshes.glb
    airlight convert room.exr room.png      images: .exr .hdr .png .jpg
    """
    reads(source)
    suffix = Path(source).suffix.lower()
    # Options that the kind of file does not know are refused first.
    check_model(source, model)
    # Images by their ending; all else is a scene or a model.
    if suffix in (*LINEAR_SUFFIXES, *DISPLAY_SUFFIXES):
        check_writable(target, IMAGES_OUT)
        convert_image(
            Path(source), target, {"exposure": exposure, "tone_map": tone_map, "lut": lut}
        )
    elif exposure is not None or tone_map is not None or lut is not None:
        raise SettingsError("--exposure, --tone-map and --lut are for images", where=source)
    else:
        convert_scene(source, target, model)
    click.echo(str(target))


def convert_image(source: Path, target: Path, shown: Mapping[str, Any] | None = None) -> None:
    """Write the image at `source` in the format of `target`'s ending.

    EXR keeps its layers in EXR. An 8-bit image is decoded from sRGB, nothing more: it is shown
    without a curve unless `shown`, the values of `display_options`, names one.
    Raises SceneError, OutputError.
    """
    from ..scene.io.images import load_image, save_image

    image = load_image(source)
    # Pixels of an 8-bit image have been through a curve already.
    if source.suffix.lower() in DISPLAY_SUFFIXES:
        image = replace(image, tone_map="none")
    save_image(displayed(image, shown) if shown else image, target)


def convert_scene(source: str, target: Path, model: Mapping[str, Any] | None = None) -> None:
    """Write the scene that `source` names as Mitsuba XML, GLB or a scene file; say what it lacks.

    `model` says how a mesh file is read: up, scale, variant.

    Raises SceneError, OutputError, ReferenceFailure, and SettingsError for another format, and
    where a scene file would lose density grids.
    """
    if target.suffix.lower() not in SCENES_OUT:
        raise SettingsError(
            f"a scene cannot be written as '{target.suffix}'",
            where=target,
            remedy="End its name in .xml, for Mitsuba 3, in .glb or in .toml.",
        )
    # What is read may be what is written: a target is checked before and after.
    check_writable(target)
    scene = load_scene(source, model)
    check_writable(target)
    # A scene file names files; what was only in memory would be lost.
    if target.suffix.lower() == ".toml":
        _refuse_loss(scene, source, target)
    if target.suffix.lower() == ".toml":
        notes = _write_toml(scene, source, target, model or {})
    elif target.suffix.lower() == ".glb":
        notes = _write_glb(scene, target)
    else:
        notes = _write_xml(scene, target)
    # What the format cannot hold is said, not left out in silence.
    show_warnings(scene)
    for note in notes:
        click.echo(f"note: {note}", err=True)


def _is_nameable(source: str) -> bool:
    """Whether a scene file can name what `source` holds, or is `source` itself."""
    from ..scene.io import MESH_SUFFIXES, VOLUME_SUFFIXES
    from ..scene.io.grid_series import is_kind

    return is_kind(source, (".toml", *MESH_SUFFIXES, *VOLUME_SUFFIXES))


def _refuse_loss(scene: Scene, source: str, target: Path) -> None:
    """Raise SettingsError where a scene file could not name what the file `source` holds.

    Meshes are written beside it. Of a builtin scene all but its grids is written, with a note.
    """
    from ..scene.io import BUILTIN_PREFIX

    if source.startswith(BUILTIN_PREFIX) or _is_nameable(source):
        return
    # A scene file names meshes and grids by path, so what came from elsewhere needs a file of its
    # own.
    held = []
    if scene.meshes and target.exists() and not target.is_file():
        held.append("meshes")  # beside a device there is no place
    if any(volume.density is not None and volume.body is None for volume in scene.volumes):
        held.append("density grids")
    if held:
        raise SettingsError(
            f"a scene file names files, and the {' and '.join(held)} of {source} are none",
            where=target,
            remedy="Convert it to .xml, which takes them along, or use it as it is.",
        )


def _write_xml(scene: Scene, target: Path) -> Sequence[str]:
    from ..reference.mitsuba import write_mitsuba

    return write_mitsuba(scene, target)


def _write_glb(scene: Scene, target: Path) -> Sequence[str]:
    from ..scene.io.gltf_write import write_gltf

    return write_gltf(scene, target)


def _write_toml(scene: Scene, source: str, target: Path, model: Mapping[str, Any]) -> Sequence[str]:
    from ..scene.io.toml_text import scene_text
    from ..scene.io.writing import whole_file

    original = scene
    # Meshes that no file holds get one beside the scene file, and so do those around media.
    scene = _with_body_files(scene, target)
    if not _is_nameable(source):
        if scene.meshes:
            source = str(_write_meshes(scene, target))
        # Of the source nothing else comes, so that the scene file says all the rest.
        original = replace(scene, lights=(), environment=None)
    text = scene_text(scene, original, source, target.parent, model=model)
    with whole_file(target) as part:
        part.write_text(text, encoding="utf-8")
    # Notes are comments of the text, and are said as well.
    return [line[2:] for line in text.splitlines() if line.startswith("# ")]


def _with_body_files(scene: Scene, target: Path) -> Scene:
    """The scene, its media in meshes with NAME_volume_1.glb and so on as their source files.

    Raises OutputError.
    """
    from ..scene import Mesh
    from ..scene.mesh import Geometry

    made = []
    for number, volume in enumerate(scene.volumes, start=1):
        # What has a file keeps it.
        if volume.body is not None and not volume.source:
            body = volume.body
            around = Mesh(Geometry(body.positions.astype("f4"), body.triangles.astype("u4")))
            alone = replace(scene, meshes=(around,))
            path = _write_meshes(alone, target, f"volume_{number}")
            volume = replace(volume, source=str(path))
        made.append(volume)
    return replace(scene, volumes=tuple(made))


def _write_meshes(scene: Scene, target: Path, kind: str = "meshes") -> Path:
    """The meshes of a scene as NAME_KIND.glb beside the scene file `target`.

    Raises OutputError where a file of that name is there that `convert` did not write.
    """
    from ..scene.io.gltf_write import is_written_here, write_gltf
    from ..scene.scene import Scene

    path = target.with_name(f"{target.stem}_{kind}.glb")
    check_writable(path)  # its name is longer than that of the scene file
    # What another program has put there is not overwritten.
    if path.exists() and not is_written_here(path):
        raise OutputError(
            f"the meshes of {target} would go here, and another file is in their place",
            where=path,
            remedy="Move it away, or give the scene file another name.",
        )
    write_gltf(Scene(meshes=scene.meshes, camera=scene.camera), path)
    return path
