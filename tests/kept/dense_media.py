"""Dense and overlapping media beside path tracing: how much light each technique has, and where.

    python tests/kept/dense_media.py [CASE ...] [--technique NAME ...] [--depth 1] [--spp 512]
        [--seed 0] [--references FOLDER]

Scenes are made here, of boxes, puffs and fog in a low sun and a weak sky; none ships. A line
per case and technique: energy over the reference's and relative L2, both images clamped at the
reference's 99.5th percentile, of the whole and of what media scatter (all orders: `pop` does not
tell them apart), and the energy of what scatters more than once where a technique draws it apart.
References are airlight's own by Mitsuba, which wants a libLLVM (`airlight doctor`); with
--references they are kept in a folder and read from there. --depth scales every extinction, so
that a remedy is judged on other depths than those that it was made on.
"""

from __future__ import annotations

import argparse
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import airlight
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Medium,
    Mesh,
    Scene,
    Volume,
)
from airlight.scene.animation.boxes import box_of, common_box
from airlight.scene.scene import volume_world_bounds
from airlight.scene.shapes import box

SIZE = (96, 54)
LAYERS = ("all", "single_scatter", "multiple_scatter")
_CLAMP = 99.5  # percentile
_UP, _SUN = 35.0, (6.0, 5.5, 5.0)  # degrees, irradiance
_VOXEL = 0.05  # metres
_SKY = (0.12, 0.16, 0.22)


def _block(
    low: Sequence[float], high: Sequence[float], per_m: float, g: float, albedo: float = 1.0
):
    """A box of one density."""
    bounds = (tuple(low), tuple(high))
    return Volume((per_m,) * 3, shape="box", bounds=bounds, g=(g,) * 3, albedo=(albedo,) * 3)


def _grid(low: Sequence[int], density: np.ndarray, per_m: float, g: float) -> Volume:
    """A density (z, y, x) whose first voxel is at `low`, in voxels of _VOXEL metres."""
    corner = np.asarray(low) * _VOXEL
    high = corner + np.array(density.shape[::-1]) * _VOXEL
    bounds = (tuple(corner), tuple(high))
    # The outermost voxels are empty, so that densities have no step at their bounds.
    inner = np.zeros(density.shape, np.float32)
    inner[1:-1, 1:-1, 1:-1] = density[1:-1, 1:-1, 1:-1]
    return Volume((1.0,) * 3, per_m * inner, bounds=bounds, g=(g,) * 3)


def _lumps(low: Sequence[int], voxels: int, per_m: float, g: float, seed: int) -> Volume:
    """A ball of lumps, its density between 0 and `per_m`."""
    z, y, x = (np.indices((voxels,) * 3) + 0.5) / voxels * 2.0 - 1.0
    lumps = np.ones((voxels,) * 3)
    for wave in np.random.default_rng(seed).normal(0.0, 3.0, (6, 4)):
        lumps += 0.25 * np.sin(wave[0] * x + wave[1] * y + wave[2] * z + 3.0 * wave[3])
    ball = np.clip(3.0 * (1.0 - np.sqrt(x * x + y * y + z * z)), 0.0, 1.0)
    return _grid(low, np.clip(lumps, 0.0, 1.0) * ball, per_m, g)


def in_one(scene: Scene) -> Scene:
    """The scene with the sum of its grids in place of them: Mitsuba knows one medium a point."""
    boxes = [box_of(volume) for volume in scene.volumes]
    box = common_box(boxes)
    density = sum(
        box.values_of(v.density, own) for v, own in zip(scene.volumes, boxes, strict=True)
    )
    placing = {"bounds": box.bounds, "world_from_volume": box.world_from_volume}
    return replace(scene, volumes=(replace(scene.volumes[0], density=density, **placing),))


def _towards(azimuth_deg: float, *, distance: float = 3.2, height: float = 1.0) -> Camera:
    """An eye that looks at the middle; 0: with the sun behind it, 180: against the sun."""
    angle = math.radians(azimuth_deg)
    eye = (distance * math.sin(angle), height, distance * math.cos(angle))
    return Camera(eye, (0.0, 0.0, 0.0), fov_y_deg=38.0)


def _scene(camera: Camera, *volumes: Volume, **more: Any) -> Scene:
    """Volumes in the sun, which comes from +z; no surfaces unless given."""
    up = math.radians(_UP)
    sun = DirectionalLight((0.0, -math.sin(up), -math.cos(up)), _SUN)
    sky = Environment(radiance=_SKY)
    return Scene(**{"lights": (sun,), "environment": sky} | more, camera=camera, volumes=volumes)


def _fog(per_m: float, g: float, azimuth: float) -> Scene:
    """The scene's own medium as a cube of a metre, dense."""
    bounds = ((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
    return _scene(_towards(azimuth), medium=Medium((per_m,) * 3, (0.98,) * 3, (g,) * 3, bounds))


def _cube(per_m: float, g: float, azimuth: float) -> Scene:
    """The same cube as a volume."""
    return _scene(_towards(azimuth), _block((-0.5,) * 3, (0.5,) * 3, per_m, g, 0.98))


def _overlap(azimuth: float) -> Scene:
    """Two boxes that share a quarter of their volume."""
    first = _grid((-14, -10, -10), np.ones((20, 20, 20)), 4.0, 0.7)
    second = _grid((-4, -6, -8), np.ones((18, 18, 20)), 8.0, 0.7)
    return _scene(_towards(azimuth), first, second)


def _behind(azimuth: float, g: float, per_m: float) -> Scene:
    """The second box in the shadow of the first, a hand apart."""
    first = _block((-0.5, -0.1, 0.1), (0.5, 0.9, 1.1), per_m, g)
    second = _block((-0.5, -0.9, -1.1), (0.5, 0.1, -0.1), per_m, g)
    return _scene(_towards(azimuth, distance=4.2), first, second)


def _side_by_side(g: float) -> Scene:
    """Two boxes a hand apart: each is lit by what the other scatters, a floor lights both."""
    place = np.diag([6.0, 0.1, 6.0, 1.0])
    place[:3, 3] = (0.0, -0.65, 0.0)
    floor = Mesh(box(), Material(base_color=(0.4, 0.4, 0.4), specular=0.0), place)
    first = _block((-1.1, -0.5, -0.5), (-0.1, 0.5, 0.5), 5.0, g)
    second = _block((0.1, -0.5, -0.5), (1.1, 0.5, 0.5), 5.0, g, 0.9)
    return _scene(_towards(40.0, distance=4.0, height=1.4), first, second, meshes=(floor,))


def _in_fog(per_m: float, g: float) -> Scene:
    """A dense puff in thin fog, over a floor."""
    place = np.diag([6.0, 0.1, 6.0, 1.0])
    place[:3, 3] = (0.0, -0.85, 0.0)
    floor = Mesh(box(), Material(base_color=(0.5, 0.45, 0.4), specular=0.0), place)
    fog = Medium((0.15,) * 3, (0.95,) * 3, (0.3,) * 3, ((-3.0, -0.8, -3.0), (3.0, 2.0, 3.0)))
    puff = _lumps((-16, -16, -16), 32, per_m, g, 5)
    return _scene(_towards(60.0, distance=4.0), puff, meshes=(floor,), medium=fog)


CASES: dict[str, Callable[[], Scene]] = {
    "fog g .6, 8 per m, towards the light": lambda: _fog(8.0, 0.6, 160.0),
    "fog g .6, 8 per m, away from it": lambda: _fog(8.0, 0.6, 20.0),
    "fog g .8, 16 per m, towards the light": lambda: _fog(16.0, 0.8, 160.0),
    "fog g .8, 16 per m, away from it": lambda: _fog(16.0, 0.8, 20.0),
    "box g .6, 8 per m, towards the light": lambda: _cube(8.0, 0.6, 160.0),
    "box g .8, 16 per m, towards the light": lambda: _cube(16.0, 0.8, 160.0),
    "box g .8, 16 per m, away from it": lambda: _cube(16.0, 0.8, 20.0),
    "overlap g .7, 4 and 8 per m, towards the light": lambda: _overlap(150.0),
    "overlap g .7, 4 and 8 per m, away from it": lambda: _overlap(30.0),
    "one behind another, g .9, 2 per m, from beside": lambda: _behind(80.0, 0.9, 2.0),
    "one behind another, g .9, 6 per m, from beside": lambda: _behind(80.0, 0.9, 6.0),
    "beside each other over a floor, g 0, 5 per m": lambda: _side_by_side(0.0),
    "beside each other over a floor, g .7, 5 per m": lambda: _side_by_side(0.7),
    "a puff of g .5, 12 per m, in fog": lambda: _in_fog(12.0, 0.5),
    "two puffs of g .7, 10 per m, overlapping": lambda: _scene(
        _towards(100.0),
        _lumps((-20, -14, -14), 28, 10.0, 0.7, 1),
        _lumps((-5, -10, -10), 24, 10.0, 0.7, 2),
    ),
}
WAYS: dict[str, tuple[str, dict[str, Any]]] = {
    "auto": ("auto", {}),
    "pop": ("pop", {}),
    "lpv-scatter": ("lpv-scatter", {}),
    "pop, split": ("pop", {"scheme": "split"}),
    "pop, in one": ("pop", {}),
}
"""Names to techniques with their settings."""


@dataclass(frozen=True)
class Score:
    """Energy over the reference's and relative L2 of the whole and of what media scatter; the
    energy of what scatters more than once, nan where it is not drawn apart."""

    whole: tuple[float, float]
    scattered: tuple[float, float]
    multiple: float


def deepened(scene: Scene, factor: float) -> Scene:
    """The scene with every extinction multiplied."""
    if factor == 1.0:
        return scene

    def scaled(part: Any) -> Any:
        return replace(part, sigma_t=tuple(factor * s for s in part.sigma_t))

    medium = None if scene.medium is None else scaled(scene.medium)
    return replace(scene, medium=medium, volumes=tuple(map(scaled, scene.volumes)))


def overlaps(scene: Scene) -> bool:
    """Whether the boxes around its grids do in the world."""
    corners = [volume_world_bounds(v) for v in scene.volumes if v.density is not None]
    pairs = itertools.combinations(corners, 2)
    return any(bool((np.maximum(a[0], b[0]) < np.minimum(a[1], b[1])).all()) for a, b in pairs)


def reference(scene: Scene, spp: int, seed: int, kept: Path | None = None) -> dict[str, Any]:
    """Mitsuba's layers, (54, 96, 3) each; from the file `kept` where there is one."""
    if kept is not None and kept.exists():
        with np.load(kept) as found:
            return dict(found)
    alone = in_one(scene) if overlaps(scene) else scene
    image = airlight.reference.render(alone, size=SIZE, spp=spp, seed=seed, layers=LAYERS)
    layers = {"all": image.radiance} | {n: image.layers[n] for n in LAYERS[1:]}
    if kept is not None:
        kept.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(kept, **layers)
    return layers


def score(scene: Scene, way: str, truth: dict[str, Any]) -> Score:
    """Of one technique with its settings (of WAYS)."""
    technique, settings = WAYS[way]
    scene = in_one(scene) if way.endswith("in one") else scene
    image = airlight.render(scene, technique=technique, size=SIZE, settings=settings)
    black = np.zeros_like(image.radiance)
    names = ("scattered", "single_scatter", "multiple_scatter")  # the first is all, of `pop`
    drawn = {name: image.layers.get(name, black) for name in names}
    scattered, multiple = sum(drawn.values()), truth["multiple_scatter"]
    # Ordinates have all orders of scattering in one layer, but for what shafts draw.
    is_apart = technique == "lpv-scatter" or (technique == "auto" and not scene.volumes)
    several = float(drawn["multiple_scatter"].sum() / multiple.sum())
    return Score(
        _compared(image.radiance, truth["all"]),
        _compared(scattered, truth["single_scatter"] + multiple),
        several if is_apart else math.nan,
    )


def _compared(image: Any, truth: Any) -> tuple[float, float]:
    """Energy ratio, and relative L2 of both clamped at the truth's percentile."""
    energy, cap = float(image.sum() / truth.sum()), np.percentile(truth, _CLAMP)
    image, truth = np.minimum(image, cap), np.minimum(truth, cap)
    return energy, math.sqrt(float(((image - truth) ** 2).sum() / (truth**2).sum()))


def ways_for(scene: Scene) -> list[str]:
    """Names of WAYS that say something on this scene: `split` is for media that exchange light."""
    is_said = {"pop, split": len(scene.volumes) > 1, "pop, in one": overlaps(scene)}
    return [way for way in WAYS if is_said.get(way, True)]


def row(name: str, way: str, found: Score) -> str:
    """A line of the table."""
    cells = [f"{e:.2f} / {off:.3f}" for e, off in (found.whole, found.scattered)]
    multiple = "" if math.isnan(found.multiple) else f"{found.multiple:.2f}"
    return "| " + " | ".join([name, f"`{way}`", *cells, multiple]) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", metavar="CASE", help="parts of their names")
    parser.add_argument("--technique", nargs="+", default=[], choices=list(WAYS))
    parser.add_argument("--depth", type=float, default=1.0, help="times every extinction")
    parser.add_argument("--spp", type=int, default=512)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--references", type=Path, help="a folder that keeps them")
    given = parser.parse_args()
    print("| case | technique | whole | scattered | more than once |\n" + "|---" * 5 + "|")
    for number, (name, made) in enumerate(CASES.items()):
        if given.cases and not any(part in name for part in given.cases):
            continue
        scene = deepened(made(), given.depth)
        file = f"{number}_{given.depth:g}_{given.spp}_{given.seed}.npz"
        kept = given.references / file if given.references else None
        truth = reference(scene, given.spp, given.seed, kept)
        for way in given.technique or ways_for(scene):
            print(row(name, way, score(scene, way, truth)), flush=True)


if __name__ == "__main__":
    main()
