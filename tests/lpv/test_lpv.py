"""What a lit floor hands to the lattice around it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.exports.solved import export_lattice
from airlight.gpu.memory import Buffer
from airlight.lattice.blockers import Blockers
from airlight.lattice.inject import Inject, Resolve, fixed_point_scale, flux_bound, new_sums
from airlight.lattice.lobes import SHAPED, InjectionTarget
from airlight.lattice.placement import Placement
from airlight.lpv.propagate import Propagate
from airlight.lpv.step import StepKind
from airlight.rendering import Renderer
from airlight.scene import Material, Medium, Scene, SpotLight
from airlight.scene.builtin import cornell
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views
from airlight.surface.reflective import ReflectiveShadowMaps, flux_unit


def test_the_first_step_of_a_blocking_floor_keeps_the_reflected_flux(gpu, commands, owned, square):
    # Lobes are shaped so that the floor, which closes the way down, costs no light.
    paint = Material(base_color=(0.8, 0.8, 0.8), specular=0.0)
    mesh = square((0, 0, 0), (4, 0, 0), (0, 0, -4), paint)
    scene, light = Scene(meshes=(mesh,)), SpotLight((0, 2, 0), (0, -1, 0), (9, 9, 9))
    room = Placement((-4.0, -4.0, -4.0), 0.5, (16, 16, 16))
    meshes = owned(GpuScene(gpu, scene))
    blockers = owned(Blockers(gpu, scene, meshes, room, 20_000))
    blockers.encode(commands)
    views = light_views([light], *meshes.bounds, 64)
    maps = owned(ReflectiveShadowMaps(gpu, "maps", 64, 1))
    maps.encode(commands, meshes, [light], views)
    sums, nbytes = owned(new_sums(gpu, room)), 3 * room.cells * 16
    zero, cells = owned(Buffer(gpu, "zero", nbytes)), owned(Buffer(gpu, "cells", nbytes))
    scale = fixed_point_scale(flux_bound([light], *meshes.bounds))
    Inject(gpu).encode(commands, maps, InjectionTarget(room, blockers.walls, sums, scale), SHAPED)
    Resolve(gpu).encode(commands, room, sums, zero, cells, scale)
    step = owned(Propagate(gpu, room, StepKind(is_blocked=True)))
    after = step.encode(commands, cells, blockers.faces, 1)
    commands.submit()
    made = after.read().reshape(3, 16, 16, 16, 4).astype(np.float64)
    tangent = (np.arange(64) + 0.5 - 32) * views[0].texel[0]
    omega = views[0].texel[0] ** 2 * (1.0 + tangent[:, None] ** 2 + tangent**2) ** -1.5
    flux = flux_unit(light) * (maps.flux.read(0)[..., 0].astype(np.float64) * omega).sum()
    assert 4.0 * np.pi * made[0, ..., 0].sum() == pytest.approx(flux, rel=1e-3)
    assert not made[:, :, :8].any()  # nothing below the floor


@pytest.mark.parametrize("scheme", ["centroid", "paper"])
def test_nothing_bounces_onto_what_faces_out_of_the_scene(scheme, gpu):
    # In front of the box's rim is nothing: no light comes from there.
    settings = {"resolution": 16, "iterations": 16, "map_resolution": 64, "scheme": scheme}
    scene = cornell()
    made = export_lattice(scene, technique="lpv", settings=settings)
    _, high = scene.bounds
    across = np.linspace(0.1, 0.9, 9)
    x = scene.bounds[0][0] + across * (high[0] - scene.bounds[0][0])
    rim = np.stack([x, np.full(9, scene.bounds[0][1]), np.full(9, high[2])], axis=1)
    out, up = np.tile([0.0, 0.0, 1.0], (9, 1)), np.tile([0.0, 1.0, 0.0], (9, 1))
    on_rim, inside = made.irradiance(rim, out), made.irradiance(rim - [0.0, 0.0, 0.5], up)
    assert inside.sum(axis=1).min() > 0.0
    assert on_rim.max() == 0.0 if scheme == "centroid" else on_rim.max() > 0.0


@pytest.mark.parametrize(
    ("resolution", "asked", "made"), [(16, {}, 64), (48, {}, 96), (48, {"iterations": 5}, 5)]
)
def test_steps_follow_the_cells_unless_they_are_given(gpu, resolution, asked, made):
    asked = {"map_resolution": 16, "surfels": 100, "resolution": resolution} | asked
    scene = dataclasses.replace(cornell(), environment=None)
    with Renderer(scene, "lpv", (8, 8), settings=asked) as renderer:
        assert renderer.stats()["iterations"] == made


def test_lattices_are_filled_again_only_where_their_light_changes(gpu, monkeypatch):
    small = {
        "resolution": 8,
        "shadow_resolution": 64,
        "map_resolution": 32,
        "sky_lights": 0,
        "surfels": 2000,
        "ambient_occlusion": False,
    }
    scene = dataclasses.replace(cornell(), medium=Medium(sigma_t=(0.1, 0.1, 0.1)))
    filled = []
    inner = Propagate.encode
    monkeypatch.setattr(
        Propagate, "encode", lambda self, *a, **k: (filled.append(1), inner(self, *a, **k))[1]
    )
    with Renderer(scene, "lpv-march", (24, 16), settings=small) as made:
        first = made.frame().radiance
        again = made.frame().radiance
        assert len(filled) == 1
        np.testing.assert_array_equal(again, first)
        made.scene = dataclasses.replace(made.scene, medium=Medium(sigma_t=(0.5, 0.5, 0.5)))
        assert np.abs(made.frame().radiance - first).max() > 0.0
        assert len(filled) == 1
        made.timed_passes()
        assert len(filled) == 2
        dimmer = [_dimmer(light) for light in scene.lights]
        darker = made.frame(lights=dimmer).radiance
        assert len(filled) == 3
        made.scene = dataclasses.replace(made.scene, medium=scene.medium)
        np.testing.assert_allclose(made.frame().radiance, 0.5 * first, rtol=2e-2, atol=1e-3)
        assert darker.mean() < first.mean()


def _dimmer(light):
    name = "irradiance" if hasattr(light, "irradiance") else "intensity"
    return dataclasses.replace(light, **{name: tuple(0.5 * v for v in getattr(light, name))})
