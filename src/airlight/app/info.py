"""`airlight info`: what a scene, an image or a density grid holds."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from ..errors import one_line
from .outputs import json_text
from .scene_argument import load_scene, show_warnings
from .scene_options import check_model, model_options

if TYPE_CHECKING:
    from ..scene import Light, Scene, Volume


@click.command("info")
@click.argument("file")
@click.option("--json", "as_json", is_flag=True, help="For a machine to read.")
@model_options()
def command(file: str, as_json: bool, model: dict[str, Any]) -> None:
    """Say what a FILE holds.

    A scene (or builtin:NAME), an image or a density grid.
    """
    from ..scene.io import VOLUME_SUFFIXES
    from ..scene.io.grid_series import kind_of
    from ..scene.io.images import IMAGE_SUFFIXES

    check_model(file, model)
    ending = kind_of(file)
    # The file's ending says which of three kinds of facts it has.
    if ending in VOLUME_SUFFIXES:
        scene = load_scene(file, model)
        facts = {**grid_facts(scene), **_file_facts(Path(file), scene)}
        if not as_json:
            show_warnings(scene)
    elif ending in IMAGE_SUFFIXES:
        facts = image_facts(Path(file))
    else:
        scene = load_scene(file, model)
        facts = {**scene_facts(scene), **_variant_facts(Path(file))}
        if not as_json:
            show_warnings(scene)
    click.echo(json_text(facts) if as_json else _text(facts))


_NO_RADIUS = ("radius", 0.0)
_MOST_EMITTERS = 20
"""As many as techniques tell apart by default."""
_MOST_LISTED = 50
"""Numbers that a line lists; --json has all of them."""


def scene_facts(scene: Scene) -> dict[str, Any]:
    """Counts, bounds in metres, and every light, as plain values."""
    from ..scene.material import textures_of

    # Meshes share materials and materials share textures; each is counted once.
    materials = {id(mesh.material): mesh.material for mesh in scene.meshes}.values()
    textures = {id(t): t for material in materials for t in textures_of(material)}.values()
    low, high = scene.bounds
    sky = scene.environment
    return {
        "kind": "scene",
        "name": scene.name,
        "meshes": len(scene.meshes),
        "triangles": scene.triangle_count,
        "materials": len(materials),
        "emissive_materials": sum(material.is_emissive for material in materials),
        "textures": len(textures),
        "texture_bytes": sum(texture.pixels.nbytes for texture in textures),
        "bounds_m": [(np.round(corner, 6) + 0.0).tolist() for corner in (low, high)],
        "lights": [_light_facts(light) for light in scene.lights],
        "surfaces_that_light": _emitter_facts(scene),
        "environment": None if sky is None else sky.source or f"radiance {list(sky.radiance)}",
        "sun_in_environment": _sun_facts(scene),
        "camera": {
            "position": scene.camera.position,
            "target": scene.camera.target,
            "fov_y_deg": scene.camera.fov_y_deg,
        },
        "image_size_px": list(scene.camera.image_size),
        "medium": None if scene.medium is None else _coefficients(scene.medium),
        "volumes": [_volume_facts(volume) for volume in scene.volumes],
        "animation": _animation_facts(scene),
        "techniques": {name: dict(values) for name, values in scene.settings.items()},
        "warnings": list(scene.warnings),
    }


def _sun_facts(scene: Scene) -> list[dict[str, Any]]:
    """What its map has that light the scene as directional lights."""
    from ..scene.map_suns import SunLights

    # What `SunLights` adds are the last lights.
    lights = SunLights().of(scene).lights[len(scene.lights) :]
    return [_light_facts(light) for light in lights]


def _variant_facts(path: Path) -> dict[str, Any]:
    """The names of a glTF file's material variants, where it has any."""
    from ..scene.io import GLTF_SUFFIXES

    if path.suffix.lower() not in GLTF_SUFFIXES:
        return {}
    from ..scene.io.gltf import variant_names

    names = variant_names(path)
    return {"variants": list(names)} if names else {}


def grid_facts(scene: Scene) -> dict[str, Any]:
    """Size, place and range of the density grid that a scene of its own shows."""
    (volume,) = scene.volumes
    assert volume.density is not None
    low, high = scene.bounds
    return {
        "kind": "density grid",
        "size_zyx": list(volume.density.shape),
        "bounds_m": [(np.round(corner, 6) + 0.0).tolist() for corner in (low, high)],
        "density": {
            "lowest": float(volume.density.min()),
            "mean": float(volume.density.mean(dtype=np.float64)),
            "highest": float(volume.density.max()),
        },
        "animation": _animation_facts(scene),
        "warnings": list(scene.warnings),
    }


def _file_facts(path: Path, scene: Scene) -> dict[str, Any]:
    """How many files a folder or pattern names, which one is shown, and the grids that it has."""
    from ..scene.io.grid_series import series_of
    from ..scene.io.grid_times import time_axes_of

    files, shown = series_of(path), Path(scene.volumes[0].source)
    counted = {"files": len(files), "shown": shown.name} if files else {}
    axes = time_axes_of(files or (shown,))
    return {**counted, **_named_grids(shown), **({"time_axes": axes} if axes else {})}


def _named_grids(path: Path) -> dict[str, Any]:
    """The grids of a file that has several or names them, and how many times those have."""
    from ..scene.io.grid_times import counted_grids

    counts = counted_grids(path)
    times = {name: count for name, count in counts.items() if count > 1}
    return {"grids": list(counts), **({"times": times} if times else {})} if counts else {}


def image_facts(path: Path) -> dict[str, Any]:
    """Size, layers and mean radiance of an image. Raises SceneError."""
    from ..scene.io.images import load_image

    image = load_image(path)
    height_px, width_px, _ = image.radiance.shape
    return {
        "kind": "picture",
        "size_px": [width_px, height_px],
        "mean_radiance": image.radiance.mean(axis=(0, 1), dtype=np.float64).tolist(),
        "layers": sorted(image.layers),
    }


def _light_facts(light: Light) -> dict[str, Any]:
    # A radius of 0 is none, and what its shape has no use for is left out.
    idle = {key.name for key in light.keys if key.control} - {k.name for k, _ in light.controls()}
    known = {
        name: value
        for name, value in vars(light).items()
        if (name, value) != _NO_RADIUS and name not in idle
    }
    return {"type": type(light).__name__.removesuffix("Light").lower(), **known}


def _emitter_facts(scene: Scene) -> list[dict[str, Any]]:
    """Emissive surfaces and lights with extent as techniques group them; power in W, by channel."""
    from ..area.emitters import Emitters

    # One sample for each, as only their number, place and power are told.
    found = Emitters(scene, samples=1, most=_MOST_EMITTERS)
    found.of(scene)
    return [
        {
            "type": emitter.shape.kind.name.lower(),
            "centre": np.round(emitter.shape.centre, 4).tolist(),
            "power": [
                float(sum(sample.light.power[c] for sample in emitter.samples)) for c in range(3)
            ],
        }
        for emitter in found.list
    ]


def _animation_facts(scene: Scene) -> dict[str, Any] | None:
    """From when to when it goes, as `airlight sequence` shows it, seconds; None for a still."""
    moving = scene.animation
    if moving is None:
        return None
    return {
        "start_s": moving.start_s,
        "end_s": moving.last_s,
        "fps": moving.fps,
        "loop": moving.is_loop,
        "frames": round((moving.last_s - moving.start_s) * moving.fps),
        "moving": [type(t).__name__.removesuffix("Track").lower() for t in moving.tracks],
    }


def _coefficients(medium: Any) -> dict[str, Any]:
    return {name: getattr(medium, name) for name in ("sigma_t", "albedo", "g", "bounds")}


def _volume_facts(volume: Volume) -> dict[str, Any]:
    size = None if volume.density is None else list(volume.density.shape)
    facts = {"shape": volume.shape, "size_zyx": size, **_coefficients(volume)}
    if volume.emission is None:
        return facts
    # Of the brightest voxel, W m^-3 sr^-1; where its density is 1 if it has no grid.
    values = volume.emission.values
    most = np.ones(3) if values is None else values.max(axis=(0, 1, 2)).astype(np.float64)
    return facts | {"emission_peak": (most * volume.emission.radiance).tolist()}


def _text(facts: Mapping[str, Any]) -> str:
    """One fact a line; a list or table one entry a line below its name."""
    lines: list[str] = []
    for name, value in facts.items():
        if name == "warnings":
            continue
        words = name.replace("_", " ")
        if isinstance(value, list) and value and isinstance(value[0], dict):
            lines += [f"{words}:", *(f"  {_inline(entry)}" for entry in value)]
        else:
            lines.append(f"{words}: {_inline(value)}")
    return "\n".join(lines)


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_inline(entry)}" for name, entry in value.items()) or "none"
    if isinstance(value, (list, tuple)):
        if not value:
            return "none"
        told = [_inline(entry) for entry in value]
        if len(told) > _MOST_LISTED:
            told = [*told[:_MOST_LISTED], f"... {len(told):,} in all ...", told[-1]]
        return "(" + ", ".join(told) + ")"
    if isinstance(value, float):
        return f"{value:.6g}"
    return "none" if value is None else one_line(str(value))
