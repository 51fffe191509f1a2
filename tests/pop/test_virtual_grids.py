"""Light from a lit surface in radial grids: where they lie, what enters them, and symmetry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.errors import DeviceError
from airlight.gpu.device import Gpu
from airlight.maths.ordinate_grid import ordinate_grids
from airlight.maths.radial_grid import radial_grid
from airlight.maths.transforms import F64
from airlight.pop.grids import grids as hop_grids
from airlight.pop.grids.grids import FAR, FIXED_POINT_BITS, GridData
from airlight.pop.grids.propagation import GridPropagation
from airlight.pop.media import PopMedia
from airlight.pop.medium.grid_medium import GridMedium
from airlight.pop.medium.placement import placed
from airlight.pop.settings import PopSettings, uses_virtual_grids
from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Material, Mesh, Scene, SpotLight, Volume
from airlight.scene.shapes import box, quad

COUNT = 6
SETTINGS = {
    "scheme": "split",
    "virtual_lights": COUNT,
    "virtual_resolution": 64,
    "grid": 8,
    "iterations": 6,
    "solver_steps": 20,
    "sky_lights": 0,
    "resolution": 16,
    "shadow_resolution": 64,
    "lamp_resolution": 128,
    "surfels": 5000,
    "march": "full",
}
ALBEDO, INTENSITY, HEIGHT = 0.6, 5.0, 0.45
INNER, OUTER = 25.0, 40.0
TURNS = [np.eye(3)[list(p)] for p in ((0, 1, 2), (1, 2, 0), (2, 0, 1))]


def over_floor(gap: float = 0.5, turn: F64 = TURNS[0], sigma: float = 4.0, g: float = 0.0) -> Scene:
    """A cube of 1 m of white air `gap` above a floor, which a spot between the two shines at.

    `turn`: where x, y and z of that go; it may mirror.
    """
    world = np.eye(4)
    world[:3, :3] = turn.T
    floor = world @ np.diag([2.0, 1.0, 2.0, 1.0])
    low, high = np.array([-0.5, gap, -0.5]), np.array([0.5, 1.0 + gap, 0.5])
    a, b = low @ turn, high @ turn
    place, down = np.array([0.0, HEIGHT, 0.0]) @ turn, np.array([0.0, -1.0, 0.0]) @ turn
    spot = SpotLight(tuple(place), tuple(down), (INTENSITY,) * 3, inner_deg=INNER, outer_deg=OUTER)
    middle = 0.5 * (a + b)
    eye = middle + np.array([0.7, 0.5, 5.0]) @ turn
    up = tuple(np.array([0.0, 1.0, 0.0]) @ turn)
    air = Volume(
        (sigma,) * 3,
        shape="box",
        g=(g,) * 3,
        bounds=(tuple(np.minimum(a, b)), tuple(np.maximum(a, b))),
    )
    return Scene(
        meshes=(Mesh(quad(), Material(base_color=(ALBEDO,) * 3, specular=0.0), floor),),
        lights=(spot,),
        volumes=(air,),
        camera=Camera(tuple(eye), tuple(middle), up=up, fov_y_deg=22.0),
    )


def solved(scene: Scene, **settings: object) -> tuple[F64, dict[str, F64]]:
    """The image of scattered light, and what the solver has: rows of grids, first power."""
    with Renderer(scene, "pop", (12, 12), settings={**SETTINGS, **settings}) as made:
        image = made.frame(samples=1)
        hopping = made.technique.find(PopMedia).solvers[0].transport.propagation
        rows = hopping.grids.rows.read(np.uint8)
        lights = made.technique.find(PopMedia).solvers[0].transport.light.table.rows.read()
        told = {
            "rows": np.frombuffer(rows.tobytes(), GridData.dtype),
            "lights": lights.reshape(-1, 4, 4),
        }
    return image.layers["scattered"].astype(np.float64), told


def rows_of(gap: float) -> tuple[np.ndarray, F64]:
    told = solved(over_floor(gap))[1]
    return told["rows"][1 : 1 + COUNT], told["lights"][1 : 1 + COUNT]


def test_rows_of_shells_are_the_hosts(gpu: Gpu) -> None:
    rows, lights = rows_of(0.5)
    at = placed(over_floor(0.5).volumes[0], 8)
    assert rows["is_radial"].all()
    for row, light in zip(rows, lights, strict=True):
        want = radial_grid(at.extent, light[2, :3], 8, 8)
        assert light[2, 1] == pytest.approx(-0.5, abs=1e-3)  # on the floor
        np.testing.assert_allclose(row["corner"], want.centre, atol=1e-6)
        assert row["radius"] == pytest.approx(want.radius, rel=1e-5)
        assert row["growth"] == pytest.approx(want.growth, rel=1e-6)
        assert tuple(row["count"]) == (8, 8, 8)
        assert 0.7 < row["mean_cosine"] < 1.0
    assert len(np.unique(rows["corner"], axis=0)) == COUNT


def test_far_lights_get_the_hosts_parallel_grids(gpu: Gpu) -> None:
    gap = 0.5 * np.sqrt(3.0) * FAR + 0.2
    rows, lights = rows_of(gap)
    at = placed(over_floor(gap).volumes[0], 8)
    assert not rows["is_radial"].any()
    for row, light in zip(rows, lights, strict=True):
        away = 0.5 * at.extent - light[2, :3]
        want = ordinate_grids(at.extent, away / np.linalg.norm(away), 8**3)
        np.testing.assert_array_equal(row["count"], want.count[0])
        assert row["cell"] == pytest.approx(want.cell[0], rel=1e-4)
        # Equally small grids may be turned otherwise: what counts is that they span the box.
        axes = np.stack([row[f"axis_{k}"] for k in "xyz"])
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-5)
        np.testing.assert_allclose(axes[2], want.axes[0, 2], atol=1e-5)
        corners = np.array(list(np.ndindex(2, 2, 2))) * at.extent
        places = (corners - row["corner"]) @ axes.T / row["cell"]
        assert places.min() > -1e-3
        assert (places < row["count"] + 1e-3).all()


def entering_power() -> float:
    """W from the floor into the box: rays of a cosine lobe from where the spot shines."""
    rng, n = np.random.default_rng(1), 400_000
    reach = HEIGHT * np.tan(np.radians(OUTER))
    xz = rng.uniform(-reach, reach, (n, 2))
    r2 = (xz**2).sum(axis=1) + HEIGHT**2
    cosine = HEIGHT / np.sqrt(r2)
    inner, outer = np.cos(np.radians([INNER, OUTER]))
    t = np.clip((cosine - outer) / (inner - outer), 0.0, 1.0)
    watts = INTENSITY * t * t * (3.0 - 2.0 * t) * cosine / r2 * ALBEDO * (2.0 * reach) ** 2 / n
    u, phi = rng.random(n), 2.0 * np.pi * rng.random(n)
    s = np.sqrt(u)
    directions = np.stack([s * np.cos(phi), np.sqrt(1.0 - u), s * np.sin(phi)], axis=1)
    from_floor = np.stack([xz[:, 0], 0.0 * u, xz[:, 1]], axis=1)
    with np.errstate(divide="ignore"):
        near = (np.array([-0.5, 0.5, -0.5]) - from_floor) / directions
        far = (np.array([0.5, 1.5, 0.5]) - from_floor) / directions
    hits = np.minimum(near, far).max(axis=1) < np.maximum(near, far).min(axis=1)
    return float(watts[hits].sum())


def test_what_enters_dense_air_is_what_the_floor_sends(gpu: Gpu) -> None:
    """All of it is scattered at once there: after one hop it is residuum, less what turned back."""
    scene = over_floor(sigma=200.0, g=0.95)
    settings = {**SETTINGS, "grid": 16, "iterations": 1, "virtual_lights": 12}
    with Renderer(scene, "pop", (8, 8), settings=settings) as made:
        made.frame(samples=1)
        solver = made.technique.find(PopMedia).solvers[0]
        cells = solver.medium.placement.cells
        deposits = solver.transport.diffuse.deposits.read().reshape(4, cells, 4)[0, :, :3]
        got = deposits.sum(axis=0) * solver.scale
    np.testing.assert_allclose(got, entering_power(), rtol=0.08)


def test_turned_scenes_scatter_as_much(gpu: Gpu) -> None:
    """The floor's side of the octahedron is cut by a seam, or its middle or corners: .08 less with
    8 cells a side, .04 with 16, where shells' cells are largest.
    """
    found = []
    for turn in (TURNS[0], TURNS[2], -TURNS[1]):
        image = solved(over_floor(g=0.5, turn=turn))[0]
        # A mirrored scene is seen mirrored.
        found.append(image if np.linalg.det(turn) > 0.0 else image[:, ::-1])
    for other, limit in zip(found[1:], (0.03, 0.1), strict=True):
        assert other.sum() == pytest.approx(found[0].sum(), rel=limit)
        assert np.linalg.norm(other - found[0]) < 0.1 * np.linalg.norm(found[0])


def test_a_plate_in_the_air_stops_what_hops(gpu: Gpu) -> None:
    """Sharp lobes from below: above a plate that cuts the medium, what diffuses is left."""
    across = np.diag([1.2, 0.02, 1.2, 1.0])
    across[1, 3] = 1.0
    plate = Mesh(box(), Material(base_color=(0.0,) * 3, specular=0.0), across)
    scene = over_floor(sigma=2.0, g=0.9)
    finer = {**SETTINGS, "grid": 16, "iterations": 10, "virtual_lights": 4}
    lights = {}
    for name, meshes in (("open", scene.meshes), ("cut", (*scene.meshes, plate))):
        with Renderer(replace(scene, meshes=meshes), "pop", (8, 8), settings=finer) as made:
            made.frame(samples=1)
            solver = made.technique.find(PopMedia).solvers[0]
            merged = solver.transport.propagation.merge.merged.read()
            lights[name] = merged.reshape(*solver.medium.placement.count[::-1], 4)[..., 0]
    assert lights["cut"][:, 11:].sum() < 0.1 * lights["open"][:, 11:].sum()
    assert lights["cut"][:, :6].sum() == pytest.approx(lights["open"][:, :6].sum(), rel=0.1)


def test_only_cells_in_the_box_hop_however_many_at_once(
    gpu: Gpu, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = []
    for most in (hop_grids.MOST_GROUPS, 2):
        few = f"const GROUP = {hop_grids.GROUP}u;\nconst MOST_GROUPS = {most}u;\n"
        monkeypatch.setattr(hop_grids, "_CONSTANTS", few)
        with Renderer(over_floor(), "pop", (8, 8), settings=SETTINGS) as made:
            found.append(made.frame(samples=1).layers["scattered"])
            grids = made.technique.find(PopMedia).solvers[0].transport.propagation.grids
            listed, groups = grids.listed.read(np.uint32), grids.groups.read(np.uint32)
            density = grids.density.read()[: grids.count * grids.capacity]
        inside = np.flatnonzero(density >= 0.0)
        assert listed[0] == len(inside) < 0.3 * len(density)
        np.testing.assert_array_equal(np.sort(listed[1 : 1 + listed[0]]), inside)
        assert tuple(groups[:3]) == (min(-(-len(inside) // hop_grids.GROUP), most), 1, 1)
    np.testing.assert_array_equal(found[0], found[1])


def test_residuum_fits_its_fixed_point(gpu: Gpu) -> None:
    """All that lamps and virtual lights can send is 2^30."""
    told = solved(over_floor())[1]
    local_light, virtual = (
        told["lights"][0, 1, :3].max(),
        told["lights"][1 : 1 + COUNT, 1, :3].max(axis=1),
    )
    most = 4.0 * np.pi * local_light + np.pi * virtual.sum()
    assert told["rows"]["fixed_scale"][0] * most == pytest.approx(2.0**FIXED_POINT_BITS, rel=1e-4)


def test_lights_of_a_dark_scene_have_no_cells(gpu: Gpu) -> None:
    scene = over_floor()
    dark = DirectionalLight((0.0, 1.0, 0.0), (1.0,) * 3)
    image, told = solved(replace(scene, lights=(dark,)))
    assert np.isfinite(image).all()
    assert (told["rows"]["count"][1 : 1 + COUNT] == 0).all()


def test_too_many_grids_are_refused(gpu: Gpu) -> None:
    medium = GridMedium(gpu, over_floor().volumes, 8)
    with pytest.raises(DeviceError, match=r"4000 grids of 64\^3 cells need \d+ MB") as told:
        GridPropagation(medium, PopSettings(grid=64), 4000)
    assert "virtual_lights" in str(told.value)


def test_who_hops() -> None:
    assert uses_virtual_grids(PopSettings(scheme="split"), alone=False)
    assert not uses_virtual_grids(PopSettings(virtual_grids="beams"), alone=True)
    assert uses_virtual_grids(PopSettings(virtual_grids="radial"), alone=True)
    assert not uses_virtual_grids(PopSettings(virtual_grids="radial"), alone=False)
