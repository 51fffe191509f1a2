"""Nested lattices end to end: as bright as one, still while the camera moves, sane at extremes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.lattice import lattices
from airlight.lattice.lattices import follow
from airlight.lpv.solver import LpvSolver
from airlight.rendering import Renderer, render
from airlight.scene import Camera, Material, Mesh, PointLight, Volume, shapes
from airlight.scene.builtin import cornell, room

SIZE = (48, 27)
SMALL = {
    "resolution": 12,
    "map_resolution": 128,
    "shadow_resolution": 256,
    "lamp_resolution": 128,
    "sky_lights": 16,
    "sky_resolution": 48,
    "surfels": 40_000,
    "iterations": 48,
    "ambient_occlusion": False,
}


def bounced(scene, **settings):
    """(H, W) mean over channels of the indirect light."""
    image = render(scene, "lpv", SIZE, settings={**SMALL, **settings}, samples=1)
    return image.layers["indirect"].mean(axis=-1).astype(np.float64)


def inside():
    """The Cornell box from inside, so that finer lattices hold what is seen."""
    return dataclasses.replace(cornell(), camera=Camera((0.5, 2.9, 2.2), (-0.6, 2.0, -2.5)))


def moved(camera, offset):
    return dataclasses.replace(
        camera,
        position=tuple(np.add(camera.position, offset)),
        target=tuple(np.add(camera.target, offset)),
    )


class Still:
    """Images from where the scene's camera is, while lattices follow another."""

    def __init__(self, scene, **settings):
        self.scene = scene
        self.renderer = Renderer(scene, "lpv", SIZE, settings={**SMALL, **settings})
        self.technique = self.renderer.technique
        self.lattices = self.technique.kit.lattices
        self.cascades = self.technique.find(LpvSolver).cascades

    def image(self, camera=None, lights=None):
        scene = dataclasses.replace(
            self.scene, camera=camera or self.scene.camera, lights=lights or self.scene.lights
        )
        r = self.renderer
        self.technique.solve(r.commands, scene)
        r.view.aim(self.scene.camera)
        self.technique.draw(r.commands, r.view)
        r.commands.submit()
        layers = self.technique.layers(r.view)
        return layers["indirect"].read()[..., :3].mean(axis=-1).astype(np.float64)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.renderer.close()


@pytest.mark.parametrize("make", [inside, pytest.param(room, marks=pytest.mark.slow)])
def test_cascades_are_as_bright_as_single_lattices_of_their_cells(gpu, make):
    # A lattice's light depends on its cells; the nested ones' lies between.
    scene = make()
    coarse, fine = bounced(scene, resolution=16), bounced(scene, resolution=30)
    nested = bounced(scene, cascades=2, resolution=16)
    low, high = sorted((coarse.mean(), fine.mean()))
    assert 0.97 * low < nested.mean() < 1.03 * high
    assert np.linalg.norm(nested - coarse) < 0.15 * np.linalg.norm(coarse)


def test_light_from_beyond_the_finer_cascade_is_not_cut_off(gpu):
    scene = inside()
    one = bounced(scene)
    whole = bounced(scene, cascades=3)
    cut = bounced(scene, cascades=3, cascade_light=False)
    assert whole.mean() == pytest.approx(one.mean(), rel=0.05)
    assert cut.mean() < 0.99 * whole.mean()


def test_a_moving_camera_changes_still_surfaces_by_little(gpu):
    # .0037; .003 to .009 by the number of cells, the more of them the less.
    scene = inside()
    with Still(scene, cascades=2, resolution=20) as still:
        fine = still.lattices.placements[0].cell
        before, origins, changes = None, set(), []
        for step in range(10):
            offset = -0.3 * fine * step * np.array([0.5, 0.2, 0.8])
            now = still.image(camera=moved(scene.camera, offset))
            origins.add(still.lattices.placements[0].origin)
            if before is not None:
                changes.append(np.abs(now - before).mean() / before.mean())
            before = now
    assert len(origins) >= 3  # lattices did move
    assert max(changes) < 0.02
    assert float(np.median(changes)) < 0.004


def test_a_moving_light_changes_light_by_little(gpu):
    local_light = PointLight((0.3, 2.6, 0.4), (4.0, 4.0, 4.0))
    scene = dataclasses.replace(inside(), lights=(local_light,))
    with Still(scene, cascades=2) as still:
        fine, changes, before = still.lattices.placements[0].cell, [], None
        for step in range(5):
            place = tuple(np.add(local_light.position, (0.25 * fine * step, 0.0, 0.0)))
            now = still.image(lights=(dataclasses.replace(local_light, position=place),))
            if before is not None:
                changes.append(np.abs(now - before).mean() / before.mean())
            before = now
    assert max(changes) < 0.06


@pytest.mark.parametrize("position", [(40.0, 30.0, 60.0), (0.1, 6.0, 30.0)])
def test_a_camera_outside_all_cascades(gpu, position):
    scene = dataclasses.replace(cornell(), camera=Camera(position, (0.0, 2.7, 0.0), fov_y_deg=8.0))
    one, three = bounced(scene), bounced(scene, cascades=2)
    assert np.isfinite(three).all()
    assert three.mean() == pytest.approx(one.mean(), rel=0.15)


@pytest.mark.parametrize("cascades", [2, 3])
def test_nothing_is_dark_beyond_cascades_smaller_than_the_scene(gpu, cascades):
    scene = cornell()
    lit = bounced(scene, cascades=cascades, cascade_extent=0.8)
    assert np.isfinite(lit).all() and lit.min() >= 0.0
    assert lit.mean() == pytest.approx(bounced(scene).mean(), rel=0.15)


def test_a_light_outside_the_lattices(gpu):
    local_light = PointLight((0.0, 2.7, 30.0), (900.0, 900.0, 900.0))
    scene = dataclasses.replace(cornell(), lights=(local_light,))
    one, two = bounced(scene), bounced(scene, cascades=2)
    assert two.mean() == pytest.approx(one.mean(), rel=0.12)


def test_light_does_not_grow_with_iterations(gpu):
    scene, few = inside(), {"cascades": 3, "tail": False}
    light = [bounced(scene, **few, iterations=n).mean() for n in (48, 120, 240)]
    assert light[0] <= light[1] * 1.001
    assert light[2] == pytest.approx(light[1], rel=0.03)


def test_a_teleport_leaves_nothing_of_where_it_was(gpu):
    scene = inside()
    away = moved(scene.camera, (-1.0, 0.0, -4.5))
    with Still(scene, cascades=3) as still:
        first = still.image()
        still.image(camera=away)
        back = still.image(camera=scene.camera)
    # hysteresis may leave a lattice a cell beside where it began
    assert np.abs(back - first).mean() < 0.01 * first.mean()


def test_lattices_go_on_to_where_a_static_camera_wants_them(gpu, monkeypatch):
    scene = inside()
    asked = []

    def counted(*given, **named):
        asked.append(given)
        return follow(*given, **named)

    monkeypatch.setattr(lattices, "follow", counted)
    settings = {"cascades": 4, "cascade_ratio": 1.5, "iterations": 1, "resolution": 8}
    with Still(scene, **settings) as still:
        still.image()
        assert len(asked) == 1
        still.image()
        assert len(asked) == 1
        # Far enough for two lattices, not so far that one of them is lost: one after the other.
        cells = [part.placement.cell for part in still.cascades]
        aside = moved(scene.camera, (0.0, 0.0, -1.2 * cells[1]))
        places = []
        for _ in range(5):
            still.image(camera=aside)
            places.append(tuple(place.origin for place in still.lattices.placements))
        assert len(set(places)) == len(asked) - 1 > 1
        assert places[-1] == places[-2] == places[-3]
        wanted = follow(still.lattices.nest, still.lattices.levels, aside, is_first=False)
        assert wanted
        assert tuple(place.origin for place in still.lattices.placements) == places[-1]


def test_a_small_object_that_moves_is_left_to_the_finest(gpu):
    with Still(inside(), cascades=2, small_objects="moving") as still:
        kinds = [part.small for part in still.cascades]
        cells = [place.cell for place in still.lattices.placements]
    assert (kinds[0].least, kinds[0].next_least) == (0.0, cells[1])
    assert (kinds[1].least, kinds[1].next_least) == (cells[1], 0.0)
    assert not kinds[0].has_static


def test_the_light_of_a_small_object_that_moved_is_missing_in_larger_lattices(gpu):
    white = Material(base_color=(0.9, 0.9, 0.9), specular=0.0)
    place = np.diag([0.12, 0.12, 0.12, 1.0])
    place[:3, 3] = (0.0, 2.7, 0.3)
    aside = place.copy()
    aside[0, 3] += 0.05
    body = Mesh(shapes.box(), white, place)
    local_light = PointLight((0.0, 4.5, 0.5), (20.0, 20.0, 20.0))
    scene = dataclasses.replace(inside(), meshes=(body,), lights=(local_light,))
    bounds = (-3.0, -0.2, -3.0, 3.0, 5.7, 2.8)
    with Still(scene, cascades=2, bounds=bounds) as still:
        for transform, has_light in ((place, True), (aside, False)):
            still.renderer.meshes.move((Mesh(body.geometry, white, transform),))
            still.image()
            fine, coarse = (
                part.injected.read().reshape(-1, 4)[:, 0].max() for part in still.cascades
            )
            assert fine > 0.0
            assert (coarse > 0.0) == has_light


def test_a_volume_of_next_to_nothing_changes_no_light():
    """Hops keep of the spread what cells ask for, beside volumes as without (.114 when not)."""
    scene, at = inside(), ((-0.5, 1.5, -3.0), (0.0, 2.0, -2.5))
    thin = Volume((1e-6,) * 3, shape="box", bounds=at)
    cells = {"resolution": 32, "iterations": 0}
    alone = bounced(scene, **cells)
    beside = bounced(dataclasses.replace(scene, volumes=(thin,)), **cells)
    # Hulls, and lattices that move to walls, are of one of them alone: measured .016.
    assert np.linalg.norm(beside - alone) < 0.03 * np.linalg.norm(alone)
