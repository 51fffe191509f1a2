"""Light that a floor reflects into thin air, beside quadrature over the floor."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.pop.virtual.lights import TILE, VirtualLights
from airlight.rendering import render
from airlight.scene import Camera, Material, Mesh, Scene, SpotLight, Volume
from airlight.scene.shapes import quad

SIZE = (9, 9)
SETTINGS = {
    "virtual_lights": 48,
    "virtual_resolution": 128,
    "grid": 8,
    "ordinates": 8,
    "sky_lights": 0,
    "resolution": 20,
    "shadow_resolution": 64,
    "lamp_resolution": 128,
    "surfels": 20000,
    "march": "full",
}
SIGMA, ALBEDO, INTENSITY = 0.02, 0.6, 5.0
SPOT = SpotLight((0.0, 1.0, 0.0), (0, -1, 0), (INTENSITY,) * 3, inner_deg=25, outer_deg=35)
LOW, HIGH = np.array([0.9, 0.2, -0.3]), np.array([1.5, 0.8, 0.3])


def scene(*meshes: Mesh) -> Scene:
    """A spot on a floor, and thin air beside its cone, seen against nothing."""
    to_world = np.diag([4.0, 1.0, 4.0, 1.0])
    floor = Mesh(quad(), Material(base_color=(ALBEDO,) * 3, specular=0.0), to_world)
    bounds = (tuple(LOW), tuple(HIGH))
    middle = 0.5 * (LOW + HIGH)
    return Scene(
        meshes=(floor, *meshes),
        lights=(SPOT,),
        volumes=(Volume((SIGMA,) * 3, shape="box", bounds=bounds),),
        camera=Camera((middle[0], middle[1], 4.0), tuple(middle), fov_y_deg=2.0),
    )


def fluence(points: np.ndarray) -> np.ndarray:
    """W m^-2 at points (n, 3): E albedo/pi cos/r^2 over the floor."""
    at = (np.arange(400) + 0.5) / 200.0 - 1.0
    x, z = (a.ravel() for a in np.meshgrid(at, at))
    r2 = 1.0 + x**2 + z**2
    cosine = 1.0 / np.sqrt(r2)
    inner, outer = np.cos(np.radians([SPOT.inner_deg, SPOT.outer_deg]))
    t = np.clip((cosine - outer) / (inner - outer), 0.0, 1.0)
    radiance = INTENSITY * t * t * (3.0 - 2.0 * t) * cosine / r2 * ALBEDO / np.pi
    away = points[:, None] - np.stack([x, 0.0 * x, z], axis=-1)
    d2 = (away**2).sum(axis=-1)
    return np.asarray((radiance * away[..., 1] / d2**1.5).sum(axis=-1) / 200.0**2)


def scattered(what: Scene, **settings: object) -> np.ndarray:
    image = render(what, "pop", SIZE, settings={**SETTINGS, **settings}, samples=1)
    return image.layers["scattered"]


def test_thin_air_scatters_what_the_floor_sends(gpu: object) -> None:
    assert VirtualLights and TILE > 1
    depth = np.linspace(LOW[2], HIGH[2], 20)
    x, y, _ = 0.5 * (LOW + HIGH)
    along = np.stack([0.0 * depth + x, 0.0 * depth + y, depth], axis=-1)
    expected = SIGMA / (4.0 * np.pi) * fluence(along).mean() * (HIGH[2] - LOW[2])
    got = scattered(scene())
    assert got[4, 4] == pytest.approx(np.full(3, expected), rel=0.05)
    assert np.array_equal(got, scattered(scene())), "the same lights every time"
    assert scattered(scene(), virtual_lights=0).max() < 0.01 * expected


def test_their_number_does_not_change_the_light(gpu: object) -> None:
    few, many = (scattered(scene(), virtual_lights=n).mean() for n in (12, 200))
    assert few == pytest.approx(many, rel=0.1)


HOPS = {"iterations": 2, "virtual_lights": 12}
TRANSPORTS = {
    "beams": {},
    "radial": {"virtual_grids": "radial", **HOPS},
    "split": {"scheme": "split", **HOPS},
}


@pytest.mark.parametrize("transport", ["radial", "split"])
def test_light_that_hops_from_it_is_the_same_in_thin_air(gpu: object, transport: str) -> None:
    beams = scattered(scene(), virtual_lights=12)
    assert scattered(scene(), **TRANSPORTS[transport])[4, 4] == pytest.approx(beams[4, 4], rel=0.03)


def test_as_printed_it_is_there_too(gpu: object) -> None:
    """Once for every cell upstream: too bright, as all light is in that scheme."""
    printed, beams = (
        scattered(scene(), scheme="paper", **HOPS),
        scattered(scene(), virtual_lights=12),
    )
    assert 1.0 < printed.mean() / beams.mean() < 20.0


@pytest.mark.parametrize("transport", TRANSPORTS)
def test_a_wall_between_keeps_it_away(gpu: object, transport: str) -> None:
    """From the floor to well above the line of sight; the spot shines beside it."""
    upright = np.array([[0, -1.2, 0, 0.75], [1.2, 0, 0, 0.6], [0, 0, 4.0, 0], [0, 0, 0, 1.0]])
    black = Material(base_color=(0.0,) * 3, specular=0.0)
    walled = scattered(scene(Mesh(quad(), black, upright)), **TRANSPORTS[transport])
    assert walled[4, 4, 0] < 0.1 * scattered(scene(), **TRANSPORTS[transport])[4, 4, 0]
