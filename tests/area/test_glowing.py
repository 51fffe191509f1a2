"""Media that give off light, as lights: their power, where it is, and what follows a frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.area.emissive_blocks import emissive_blocks
from airlight.area.emitters import Emitters
from airlight.area.glowing import EACH, MOST
from airlight.area.grouping import MOST_LAYERS
from airlight.errors import SettingsError
from airlight.scene import Camera, Emission, Material, Medium, Mesh, PointLight, Scene, Volume
from airlight.scene.lights import LightSample
from airlight.scene.shapes import quad

BOX = ((-1.0, 0.0, -0.5), (1.0, 3.0, 1.5))
GLOW = (4.0, 2.0, 0.5)


def made(*volumes: Volume, **more: object) -> tuple[Emitters, Scene]:
    scene = Scene(volumes=volumes, camera=Camera((0, 0, 9), (0, 0, 0)), **more)
    found = Emitters(scene, samples=16, most=20)
    return found, found.of(scene)


def fire(
    shape: tuple[int, int, int] = (20, 30, 21), seed: int = 3, per_m: float = 0.1, g: float = 0.0
) -> Volume:
    grid = np.random.default_rng(seed).random((*shape, 3), dtype=np.float32) ** 4
    density = np.ones(shape, np.float32)
    placed = np.array([[0, -2, 0, 1], [1, 0, 0, 5], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    return Volume(
        (per_m,) * 3,
        density,
        bounds=BOX,
        g=(g,) * 3,
        world_from_volume=placed,
        emission=Emission(GLOW, grid),
    )


def power(lights: object) -> np.ndarray:
    return np.sum([light.power for light in lights], axis=0)  # type: ignore[attr-defined]


def test_a_grid_gives_all_its_power_where_it_glows() -> None:
    volume = fire()
    found, seen = made(volume)
    values = volume.emission.values.astype(np.float64)
    # Twice the box's 12 m^3, by the transform.
    expected = 4.0 * np.pi * np.array(GLOW) * values.mean(axis=(0, 1, 2)) * 24.0
    lights = [light for light in seen.lights if isinstance(light, LightSample)]
    assert len(lights) == EACH
    np.testing.assert_allclose(power(lights), expected, rtol=1e-6)
    samples = [s.light for e in found.list for s in e.samples]
    assert len(samples) == 16
    np.testing.assert_allclose(power(samples), expected, rtol=1e-6)
    # The centre of light stays, in the world.
    weight = values.mean(axis=3)
    axes = [(np.arange(n) + 0.5) / n for n in weight.shape]
    own = [
        np.average(a, weights=weight.sum(axis=tuple({0, 1, 2} - {k}))) for k, a in enumerate(axes)
    ]
    at = np.array(BOX[0]) + np.array(own[::-1]) * np.subtract(BOX[1], BOX[0])
    centre = volume.world_from_volume[:3, :3] @ at + volume.world_from_volume[:3, 3]
    mean = np.average(
        [light.position for light in samples], axis=0, weights=[light.power[0] for light in samples]
    )
    np.testing.assert_allclose(mean, centre, atol=0.06)


def test_dense_media_are_cut_into_more_groups() -> None:
    """What is near the border counts for most of what leaves; forward scattering keeps none in."""
    counts = [len(made(fire(per_m=x))[0].list) for x in (0.1, 0.7, 20.0)]
    assert counts[0] == EACH < counts[1] < counts[2] == MOST
    assert len(made(fire(per_m=0.7, g=0.9))[0].list) == EACH
    # Smoke around counts as the fire's own, beside it does not.
    smoke = Volume((20.0,) * 3, shape="box", bounds=((-9.0,) * 3, (9.0,) * 3))
    assert len(made(fire(), smoke)[0].list) == MOST
    apart = replace(smoke, world_from_volume=np.eye(4) + 40.0 * np.eye(4, k=3))
    assert len(made(fire(), apart)[0].list) == EACH
    fog = Medium((20.0,) * 3, bounds=((-9.0,) * 3, (9.0,) * 3))
    assert len(made(fire(), medium=fog)[0].list) == MOST


@pytest.mark.parametrize(("shape", "volume"), [("box", 12.0), ("sphere", 12.0 * np.pi / 6.0)])
def test_shapes_and_media_give_theirs(shape: str, volume: float) -> None:
    _, seen = made(Volume((1.0,) * 3, shape=shape, bounds=BOX, emission=Emission(GLOW)))
    expected = 4.0 * np.pi * np.array(GLOW) * volume
    np.testing.assert_allclose(power(seen.lights), expected, rtol=5e-3)
    medium = Medium((0.1,) * 3, bounds=BOX, emission=GLOW)
    _, seen = made(medium=medium)
    np.testing.assert_allclose(power(seen.lights), 4.0 * np.pi * np.array(GLOW) * 12.0, rtol=1e-6)


def test_frames_keep_the_groups_and_take_the_light() -> None:
    volume = fire()
    local_light, panel = (
        PointLight((0, 5, 0), (9, 9, 9)),
        Mesh(quad(), Material(emission=(1, 1, 1))),
    )
    found, seen = made(volume, lights=(local_light,), meshes=(panel,))
    assert seen.lights[0] == local_light
    assert found.count == len(found.list) == 1 + 1 + EACH
    rows = [e.row for e in found.list[-EACH:]]
    assert rows == list(range(len(seen.lights) - EACH, len(seen.lights)))
    scene = Scene(volumes=(volume,), lights=(local_light,), meshes=(panel,))
    before, version = power(seen.lights[-EACH:]), found.version
    assert found.of(replace(scene, camera=Camera((0, 1, 9), (0, 0, 0)))).lights == seen.lights
    brighter = replace(volume, emission=Emission((8.0, 4.0, 1.0), volume.emission.grid))
    seen = found.of(replace(scene, volumes=(brighter,)))
    assert found.version > version
    np.testing.assert_allclose(power(seen.lights[-EACH:]), 2.0 * before)
    dark = replace(volume, emission=Emission(GLOW, 0.0 * volume.emission.grid))
    seen = found.of(replace(scene, volumes=(dark,)))
    assert power(seen.lights[-EACH:]).max() == 0.0
    assert np.isfinite([light.position for light in seen.lights]).all()
    with pytest.raises(SettingsError, match="other grids"):
        found.of(replace(scene, volumes=(fire((3, 4, 5)),)))


def test_many_fires_share_what_devices_have() -> None:
    fires = [replace(fire((4, 4, 4), k), world_from_volume=shifted(9.0 * k)) for k in range(30)]
    found, seen = made(*fires)
    assert found.layers <= MOST_LAYERS
    assert len(seen.lights) <= 12
    blocks = emissive_blocks(Scene(volumes=tuple(fires)))
    assert blocks is not None
    expected = 4.0 * np.pi * blocks.intensity.sum(axis=0)
    np.testing.assert_allclose(power(seen.lights), expected, rtol=1e-6)


def test_later_samples_of_a_still_lie_elsewhere() -> None:
    found, _ = made(fire())
    first = [s.light.position for e in found.list for s in e.samples]
    later = [s.light.position for e in found.jittered(3) for s in e.samples]
    assert len(first) == len(later) == 16
    assert all(a != b for a, b in zip(first, later, strict=True))


def shifted(x: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix
