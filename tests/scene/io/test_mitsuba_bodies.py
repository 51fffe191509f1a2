"""Media in what Mitsuba's meshes enclose: as much of them as there is, and where it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from airlight.maths.weld import welded
from airlight.scene import Scene
from airlight.scene.io.mitsuba import load_mitsuba
from airlight.scene.shapes import sphere
from airlight.scene.volume import Volume

SENSOR = '<sensor type="perspective"/>'
MEDIUM = (
    '<medium id="fog" type="homogeneous"><rgb name="sigma_t" value="0.5"/>'
    '<float name="scale" value="2"/><rgb name="albedo" value="0.8"/></medium>'
)
HELD = '<bsdf type="null"/><ref name="interior" id="fog"/>'
R, TUBE = 1.0, 0.4


def torus(around: int = 64, across: int = 32) -> tuple[np.ndarray, np.ndarray]:
    """Vertices, and triangles that face out."""
    u, v = (np.arange(n) * 2 * np.pi / n for n in (around, across))
    u, v = np.meshgrid(u, v, indexing="ij")
    out = R + TUBE * np.cos(v)
    points = np.stack([out * np.cos(u), TUBE * np.sin(v), out * np.sin(u)], axis=-1)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = i * across + j, (i + 1) % around * across + j
    c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    faces = np.concatenate([np.stack([a, c, b], -1), np.stack([a, d, c], -1)]).reshape(-1, 3)
    return points.reshape(-1, 3), faces


def ball() -> tuple[np.ndarray, np.ndarray]:
    """Of radius 1, each vertex once."""
    shape = sphere(48, 24)
    number = welded(shape.positions)
    points = np.zeros((number.max() + 1, 3))
    points[number] = 2.0 * shape.positions
    return points, number[shape.indices]


def volume_of(points: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = np.moveaxis(points[faces], 1, 0)
    return abs(float(np.einsum("tk,tk->", a, np.cross(b, c)))) / 6.0


def write_obj(path: Path, points: np.ndarray, faces: np.ndarray) -> None:
    lines = [f"v {x:.8f} {y:.8f} {z:.8f}" for x, y, z in points]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    path.write_text("\n".join(lines) + "\n")


def read(folder: Path, body: str) -> Scene:
    (folder / "a.xml").write_text(f'<scene version="3.0.0">{SENSOR}{body}</scene>')
    return load_mitsuba(folder / "a.xml")


def obj(name: str, inner: str = HELD) -> str:
    return f'<shape type="obj"><string name="filename" value="{name}.obj"/>{inner}</shape>'


def held(volume: Volume) -> float:
    """Extinction times its volume, m^2."""
    assert volume.density is not None
    size = np.prod(np.subtract(volume.bounds[1], volume.bounds[0]))
    size *= abs(np.linalg.det(volume.world_from_volume[:3, :3]))
    return float(volume.density.mean(dtype=np.float64) * size * volume.sigma_t[0])


def at(volume: Volume, place: tuple[float, float, float]) -> float:
    """The density of the voxel there."""
    low, high = np.array(volume.bounds)
    assert volume.density is not None
    size = np.array(volume.density.shape[::-1])
    i, j, k = np.floor((np.array(place) - low) / (high - low) * size).astype(int)
    return float(volume.density[k, j, i])


def test_a_torus_holds_its_medium_whichever_way_it_faces(tmp_path: Path) -> None:
    points, faces = torus()
    rng = np.random.default_rng(2)
    mixed = np.where(rng.random(len(faces))[:, None] < 0.3, faces[:, ::-1], faces)
    for name, triangles in (("out", faces), ("in", faces[:, ::-1]), ("mixed", mixed)):
        write_obj(tmp_path / f"{name}.obj", points, triangles)
        scene = read(tmp_path, MEDIUM + obj(name))
        assert scene.warnings == () and scene.meshes == () and scene.medium is None
        (volume,) = scene.volumes
        # Measured: 3e-4; the issue is that it is no longer the box, which holds 2.5 times as much.
        assert held(volume) == pytest.approx(volume_of(points, faces), rel=2e-3)
        assert volume.albedo == pytest.approx((0.8,) * 3)
        assert at(volume, (0.0, 0.0, 0.0)) == 0.0 and at(volume, (R, 0.0, 0.0)) == 1.0
        assert volume.density is not None and 64 <= max(volume.density.shape) <= 130
        assert volume.density[[0, -1]].max() == volume.density[:, :, [0, -1]].max() == 0.0


def test_its_volume_follows_turns_scales_and_mirrors(tmp_path: Path) -> None:
    points, faces = torus(32, 16)
    write_obj(tmp_path / "t.obj", points, faces)
    for steps, factor in (
        ('<rotate x="1" y="2" z="3" angle="40"/>', 1.0),
        ('<scale x="2" y="-1" z="0.5"/><rotate z="1" angle="20"/>', 1.0),
        ('<scale value="1000"/><translate x="5000"/>', 1e9),
    ):
        place = f'<transform name="to_world">{steps}</transform>'
        (volume,) = read(tmp_path, MEDIUM + obj("t", place + HELD)).volumes
        assert held(volume) == pytest.approx(factor * volume_of(points, faces), rel=3e-3), steps


def test_parts_are_united_and_cavities_stay_empty(tmp_path: Path) -> None:
    points, faces = ball()
    one = volume_of(points, faces)
    both = np.concatenate([faces, faces + len(points)])
    apart = np.concatenate([points, points + np.array([3.0, 0.0, 0.0])])
    write_obj(tmp_path / "apart.obj", apart, both)
    (volume,) = read(tmp_path, MEDIUM + obj("apart")).volumes
    assert held(volume) == pytest.approx(2 * one, rel=3e-3)
    # Two balls whose middles are a radius apart: 2 V less the lens, 5/16 of a ball.
    across = np.concatenate([points, points + np.array([1.0, 0.0, 0.0])])
    write_obj(tmp_path / "across.obj", across, both)
    (volume,) = read(tmp_path, MEDIUM + obj("across")).volumes
    assert held(volume) == pytest.approx((2 - 5 / 16) * one, rel=3e-3)
    assert at(volume, (0.5, 0.0, 0.0)) == 1.0
    hollow = np.concatenate([faces, faces[:, ::-1] + len(points)])
    write_obj(tmp_path / "hollow.obj", np.concatenate([points, 0.5 * points]), hollow)
    (volume,) = read(tmp_path, MEDIUM + obj("hollow")).volumes
    assert held(volume) == pytest.approx(7 / 8 * one, rel=3e-3)
    assert at(volume, (0.0, 0.0, 0.0)) == 0.0


def test_open_meshes_get_lids_and_a_warning(tmp_path: Path) -> None:
    points, faces = ball()
    cut = faces[(points[faces][..., 1] <= 0.51).all(axis=1)]
    write_obj(tmp_path / "cut.obj", points, cut)
    scene = read(tmp_path, MEDIUM + obj("cut"))
    (warning,) = scene.warnings
    assert warning.startswith("shape (obj): it is open, and its medium ends at lids across its hol")
    top = points[np.unique(cut)][:, 1].max()
    cap = np.pi * (1 - top) ** 2 * (2 + top) / 3
    (volume,) = scene.volumes
    # Of the ball itself; its facets have .992 of it.
    assert held(volume) == pytest.approx(4 / 3 * np.pi - cap, rel=0.012)
    assert volume.bounds[1][1] < top + 0.1
    # A cylinder is open on both sides.
    tube = '<float name="radius" value="0.5"/><point name="p1" x="1" y="2" z="3"/>'
    scene = read(tmp_path, f'{MEDIUM}<shape type="cylinder">{tube}{HELD}</shape>')
    assert held(scene.volumes[0]) == pytest.approx(np.pi / 4 * np.sqrt(14), rel=3e-3)
    assert "lids across its holes (2)" in scene.warnings[0]


def test_a_sheet_encloses_nothing(tmp_path: Path) -> None:
    scene = read(tmp_path, f'{MEDIUM}<shape type="disk">{HELD}</shape>')
    assert scene.volumes == ()
    assert scene.warnings[-1] == "shape (disk) encloses nothing: its medium is left out"


def test_open_shapes_of_one_medium_close_a_body_together(tmp_path: Path) -> None:
    lids = "".join(
        f'<shape type="disk"><transform name="to_world"><scale value="0.5"/>{turn}</transform>'
        f"{HELD}</shape>"
        for turn in ('<translate z="2"/>', '<rotate x="1" angle="180"/>')
    )
    size = '<float name="radius" value="0.5"/><point name="p1" x="0" y="0" z="2"/>'
    scene = read(tmp_path, f'{MEDIUM}<shape type="cylinder">{size}{HELD}</shape>{lids}')
    assert scene.warnings == ()
    (volume,) = scene.volumes
    assert held(volume) == pytest.approx(np.pi / 2, rel=3e-3)


def grid_medium(folder: Path, values: np.ndarray, box: str = "") -> str:
    from airlight.reference.mitsuba_files import write_vol

    write_vol(folder / "g.vol", values.astype(np.float32), ((0, 0, 0), (1, 1, 1)))
    return (
        '<bsdf type="null"/><medium name="interior" type="heterogeneous">'
        '<volume type="gridvolume" name="sigma_t"><string name="filename" value="g.vol"/>'
        f'<transform name="to_world">{box}<translate x="-0.5" y="-0.5" z="-0.5"/>'
        '<scale value="2"/></transform></volume></medium>'
    )


def test_a_grid_is_cut_by_its_shape(tmp_path: Path) -> None:
    """Of any kind: a mesh, a sphere, a smaller cube; one around the grid leaves it as it is."""
    points, faces = ball()
    write_obj(tmp_path / "ball.obj", points, faces)
    values = np.ones((2, 3, 4))
    values[1] = 3.0  # the mean is 2, and so it is within a ball, which is as much above as below
    medium = grid_medium(tmp_path, values)
    for shape, volume_m3, rel in (
        (obj("ball", medium), volume_of(points, faces), 3e-3),
        (f'<shape type="sphere">{medium}</shape>', 4 / 3 * np.pi, 4e-3),
        (
            '<shape type="cube"><transform name="to_world"><scale x="0.5"/></transform>'
            f"{medium}</shape>",
            4.0,
            1e-6,
        ),
    ):
        (volume,) = read(tmp_path, shape).volumes
        assert held(volume) == pytest.approx(2.0 * volume_m3, rel=rel)
        assert volume.density is not None and max(volume.density.shape) == 64
    (volume,) = read(tmp_path, f'<shape type="cube">{medium}</shape>').volumes
    assert volume.density is not None and volume.density.shape == (2, 3, 4)
    assert held(volume) == pytest.approx(16.0)
    # A shape that the grid lies in leaves it alone as well.
    far = '<transform name="to_world"><scale value="4"/></transform>'
    (volume,) = read(tmp_path, obj("ball", far + medium)).volumes
    assert volume.density is not None and volume.density.shape == (2, 3, 4)
