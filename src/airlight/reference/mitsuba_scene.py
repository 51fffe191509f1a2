"""Any airlight scene as a Mitsuba 3 scene: an XML file and a folder of what it names."""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from ..errors import OutputError
from ..scene.checks import Rgb
from ..scene.io.ledger import check_output
from ..scene.io.writing import check_target, unwritable, whole_file
from ..scene.medium import Medium
from ..scene.scene import Scene
from ..scene.volume import Volume
from .mitsuba_emission import emission_balls
from .mitsuba_files import FileStore, is_written
from .mitsuba_lights import environment_emitter, has_glow, light_elements, point_emitters
from .mitsuba_material import is_masked
from .mitsuba_media import Media, has_media, medium_bounds, scene_media
from .mitsuba_shapes import mesh_shapes
from .mitsuba_xml import (
    add_integer,
    add_lookat,
    add_number,
    add_reference,
    add_text,
    add_truth,
    plugin,
)

_OTHER_NAME = "Choose another name for the scene."
VISIBLE_ENVIRONMENT = "the environment is visible: Mitsuba hides all emitters or none"


@dataclass(frozen=True)
class Exported:
    """A scene written for Mitsuba.

    `notes`: what was approximated. `has_media`, `has_masks`: what the integrator must cope
    with. `integrator`: the Mitsuba plugin that fits.
    """

    notes: tuple[str, ...]
    has_media: bool
    has_masks: bool
    integrator: str


def write_mitsuba(scene: Scene, path: Path) -> list[str]:
    """Write `scene` as Mitsuba XML to `path`, its meshes and images into NAME_files beside it.

    Both appear whole or not at all. Returns what was approximated, a sentence each.
    Raises OutputError, and ReferenceFailure for media that Mitsuba cannot hold.
    """
    path = Path(path)
    prefix = f"{path.stem}_files"
    # All is written beside the target, and takes its place when it is whole.
    staged = path.parent / f".{prefix}.{os.getpid()}.part"
    check_target(path)
    try:
        _check_folder(path.parent / prefix, path)
        staged.mkdir(parents=False)
    except OSError as error:
        raise unwritable(path, error) from None
    try:
        # What Mitsuba cannot say is told, not refused.
        notes: list[str] = []
        if not _has_grey_g(scene):
            notes.append("g differs between the channels, written as its mean")
        if scene.camera.exposure_stops != 0.0:
            notes.append("the camera's exposure is left out: Mitsuba's images have none")
        size = scene.camera.image_size
        exported = export(scene, staged, path.stem, prefix, size=size, notes=notes)

        # Folder first, then the XML that names it: a reader of the new XML finds its files.
        _replace_folder(staged, path.parent / prefix)
        made = path.parent / prefix / f"{path.stem}.xml"
        with whole_file(path) as part:
            shutil.copyfile(made, part)
        made.unlink()
    except OSError as error:
        raise unwritable(path, error) from None
    finally:
        shutil.rmtree(staged, ignore_errors=True)
    return list(exported.notes)


def _check_folder(folder: Path, path: Path) -> None:
    """Raise OutputError unless `folder` can be replaced: only our files, none of them an input."""
    # A folder that airlight did not write is never replaced.
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise OutputError(
            f"'{folder.name}' beside it is not a folder", where=path, remedy=_OTHER_NAME
        )
    for file in sorted(folder.iterdir()) if folder.exists() else ():
        if not is_written(file.name, path.stem):
            raise OutputError(
                f"'{folder.name}' beside it holds '{file.name}', which is no file of such a scene",
                where=path,
                remedy=_OTHER_NAME,
            )
        check_output(file)


def _replace_folder(staged: Path, target: Path) -> None:
    # Renamed aside before the new one takes its name: at no time is half a folder there.
    old = staged.with_suffix(".old")
    if target.exists():
        target.replace(old)
    staged.replace(target)
    shutil.rmtree(old, ignore_errors=True)


def export(
    scene: Scene,
    folder: Path,
    stem: str,
    prefix: str,
    *,
    size: tuple[int, int] = (1280, 720),
    spp: int = 256,
    notes: list[str] | None = None,
    knows_airlight: bool = False,
) -> Exported:
    """Write STEM.xml and what it needs into `folder`, naming files as PREFIX/name.

    `prefix` "." names them beside the XML. `knows_airlight`: see FileStore.
    """
    notes = [] if notes is None else notes
    files = FileStore(folder, prefix, knows_airlight=knows_airlight)
    diagonal = scene_diagonal(scene)
    # Surfaces, media and everything that sends light, in Mitsuba's terms.
    shapes = [shape for mesh in scene.meshes for shape in mesh_shapes(mesh, diagonal, files, notes)]
    media = scene_media(scene, files, notes)
    emitters = [e for light in scene.lights for e in light_elements(light, files, notes)]
    emitters += [
        emitter for group in scene.light_groups for emitter in point_emitters(group, files)
    ]
    emitters += emission_balls(scene, notes)
    if scene.environment is not None:
        emitters.append(environment_emitter(scene.environment, files))

    # Masks and glass need an integrator that follows light straight through surfaces.
    has_masks = any(
        is_masked(mesh.material, mesh.geometry) or mesh.material.is_translucent
        for mesh in scene.meshes
    )
    integrator = _integrator(media, has_masks)

    # What is referred to stands first: materials and media before the shapes that use them.
    root = _root(integrator, size, spp)
    root.append(_hiding(plugin("integrator", integrator), scene, notes))
    root.extend(files.bsdfs.values())
    root.extend(media.mediums)
    root.append(_sensor(scene, diagonal, media.camera_id))
    root.extend(media.boundaries)
    root.extend(shapes)
    root.extend(emitters)
    _write_xml(root, folder / f"{stem}.xml")
    return Exported(tuple(dict.fromkeys(notes)), has_media(scene), has_masks, integrator)


def with_grey_g(scene: Scene, channel: int) -> Scene:
    """The scene with every g that of one channel: Mitsuba's phase functions are grey."""

    def grey(g: Rgb) -> Rgb:
        return (g[channel],) * 3

    medium = scene.medium and replace(scene.medium, g=grey(scene.medium.g))
    volumes = tuple(_with_grey_g(volume, channel) for volume in scene.volumes)
    return replace(scene, medium=medium, volumes=volumes)


def _with_grey_g(volume: Volume, channel: int) -> Volume:
    if volume.g_grid is not None:
        return replace(volume, g_grid=volume.g_grid[..., channel])
    return replace(volume, g=(volume.g[channel],) * 3)


def _has_grey_g(scene: Scene) -> bool:
    holders: list[Medium | Volume] = [*scene.volumes, *([scene.medium] if scene.medium else [])]
    return all(len(set(holder.g)) == 1 for holder in holders)


def g_channels(scene: Scene) -> tuple[int, ...]:
    """Channels that need a render of their own: one where g is grey, else three."""
    return (0,) if _has_grey_g(scene) else (0, 1, 2)


def scene_diagonal(scene: Scene) -> float:
    """Length of the box around surfaces, volumes, camera and air with an end, metres."""
    # Everything that can be seen, and the eye itself.
    low, high = scene.bounds
    eye = np.array(scene.camera.position)
    low, high = np.minimum(low, eye), np.maximum(high, eye)
    if scene.medium is not None and not scene.medium.endless:
        medium_low, medium_high = medium_bounds(scene)
        low, high = np.minimum(low, medium_low), np.maximum(high, medium_high)
    return float(np.linalg.norm(high - low))


def _root(integrator: str, size: tuple[int, int], spp: int) -> Element:
    root = Element("scene", {"version": "3.0.0"})

    # Defaults of the file's parameters, which Mitsuba's loader and command line can set.
    defaults = {"integrator": integrator, "max_depth": -1, "spp": spp}
    for name, value in (*defaults.items(), ("width", size[0]), ("height", size[1])):
        if name != "integrator":
            SubElement(root, "default", {"name": name, "value": str(value)})
    return root


def _integrator(media: Media, has_masks: bool) -> str:
    """path cannot see light through masks or media; volpathmis pays off for coloured air."""
    if media.is_colored:
        return "volpathmis"
    return "volpath" if media.mediums or has_masks else "path"


def _hiding(integrator: Element, scene: Scene, notes: list[str]) -> Element:
    # Mitsuba hides all emitters at once, so what glows keeps the environment visible.
    add_integer(integrator, "max_depth", "$max_depth")
    if scene.environment is None or scene.environment.visible:
        return integrator
    if has_glow(scene):
        notes.append(VISIBLE_ENVIRONMENT)
    else:
        add_truth(integrator, "hide_emitters", True)
    return integrator


def _sensor(scene: Scene, diagonal: float, medium_id: str) -> Element:
    camera = scene.camera
    has_lens = camera.aperture_m > 0.0
    sensor = plugin("sensor", "thinlens" if has_lens else "perspective")
    if has_lens:
        focus = float(np.linalg.norm(np.subtract(camera.target, camera.position)))
        add_number(sensor, "aperture_radius", camera.aperture_m / 2.0)
        add_number(sensor, "focus_distance", focus if camera.focus_m is None else camera.focus_m)
    # Where it stands, and a range of depths that cuts nothing off.
    add_lookat(sensor, "to_world", camera.position, camera.target, camera.up)
    add_number(sensor, "fov", camera.fov_y_deg)
    add_text(sensor, "fov_axis", "y")
    add_number(sensor, "near_clip", 1e-6 * diagonal)
    add_number(sensor, "far_clip", 1e3 * diagonal)
    if medium_id:
        add_reference(sensor, medium_id, "medium")
    # Pixels as sums of samples without a filter, as airlight's are.
    film = plugin("film", "hdrfilm")
    add_integer(film, "width", "$width")
    add_integer(film, "height", "$height")
    add_text(film, "pixel_format", "rgb")
    add_text(film, "component_format", "float32")
    film.append(plugin("rfilter", "box"))
    sensor.append(film)
    sampler = plugin("sampler", "independent")
    add_integer(sampler, "sample_count", "$spp")
    sensor.append(sampler)
    return sensor


def _write_xml(root: Element, path: Path) -> None:
    indent(root, "  ")
    path.write_bytes(tostring(root, encoding="utf-8", xml_declaration=True) + b"\n")
