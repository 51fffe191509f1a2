"""What the viewer shows is solved only where something changed that counts."""

from __future__ import annotations

from dataclasses import replace

import pytest

from airlight.app.view.drawn import QUICK_COARSENESS, QUICK_STEPS, Drawn
from airlight.errors import DeviceError
from airlight.lpv.solver import LpvSolver
from airlight.rendering import Renderer
from airlight.scene import Camera, Mesh, PointLight, Scene
from airlight.scene.io import load
from airlight.scene.shapes import box
from small_viewer import SETTINGS

SMALL = {**SETTINGS, "map_resolution": 32}


def drawn_with(**settings) -> Drawn:
    try:
        made = Renderer(load("builtin:cornell"), "lpv", (16, 9), settings={**SMALL, **settings})
    except DeviceError as error:
        pytest.skip(str(error))
    return Drawn(made)


def solved(drawn: Drawn, scene) -> int:
    """How often it is solved for `scene`."""
    calls: list[int] = []
    inner = drawn.renderer.technique.solve
    drawn.renderer.technique.solve = lambda *a, **named: (calls.append(1), inner(*a, **named))
    drawn.give(scene)
    drawn.solve(drawn.renderer.commands)
    drawn.renderer.technique.solve = inner
    return len(calls)


def moved(scene):
    x, y, z = scene.camera.position
    return replace(scene, camera=replace(scene.camera, position=(x + 0.1, y, z)))


def test_a_camera_needs_no_solution_and_other_meshes_do():
    drawn = drawn_with()
    scene = drawn.renderer.scene
    assert solved(drawn, scene) == 1
    assert drawn.solve_ms > 0.0 or not drawn.renderer.gpu.is_cpu
    assert solved(drawn, moved(scene)) == 0
    assert drawn.solve_ms == 0.0
    other = (replace(scene.meshes[0], name="other"), *scene.meshes[1:])
    assert solved(drawn, replace(scene, meshes=other)) == 1
    drawn.close()


def test_a_camera_that_goes_through_a_closed_wall_sees_what_it_hid():
    """A light in a closed box is dark for an eye outside, and is lit when the eye goes in."""
    light = PointLight((0.2, 0.1, 0.0), (1.0, 1.0, 1.0))
    outside = Camera((1.2, 0.3, 0.9), (0.0, 0.0, 0.0))
    scene = Scene((Mesh(box()),), (light,), camera=outside)
    try:
        drawn = Drawn(Renderer(scene, "lpv", (16, 9), settings=SMALL))
    except DeviceError as error:
        pytest.skip(str(error))
    assert solved(drawn, scene) == 1
    assert solved(drawn, replace(scene, camera=replace(outside, position=(1.3, 0.3, 0.9)))) == 0
    inside = replace(scene, camera=replace(outside, position=(-0.2, 0.1, 0.3)))
    assert solved(drawn, inside) == 1
    assert solved(drawn, moved(inside)) == 0
    drawn.close()


def test_a_moving_light_makes_fewer_steps_and_coarser_shadows_until_it_rests():
    drawn = drawn_with(iterations=64)
    r, steps, coarse = drawn.renderer, [], []
    if not r.gpu.is_cpu:
        pytest.skip("a GPU has time for all steps")
    inner = r.technique.solve
    r.technique.solve = lambda *a, **named: (
        steps.append(r.technique.find(LpvSolver).steps),
        coarse.append(r.technique.kit.lights.coarseness),
        inner(*a, **named),
    )
    for is_quick in (True, True, False, False, True):
        drawn.solve(r.commands, is_quick=is_quick)
    assert steps == [QUICK_STEPS, 64]  # once quickly, once in full, which then does for both
    assert coarse == [QUICK_COARSENESS, 1.0]
    assert r.technique.find(LpvSolver).steps == 64
    drawn.close()


def test_while_a_light_moves_lattices_lag_and_are_solved_when_there_is_time(monkeypatch):
    from airlight.app.view import drawn as module

    drawn = drawn_with()
    r, clock, solved_s = drawn.renderer, [0.0], []
    if not r.gpu.is_cpu:
        pytest.skip("a GPU has time for lattices")
    lattice = r.technique.find(LpvSolver)
    inner = lattice.solve
    monkeypatch.setattr(
        lattice,
        "solve",
        lambda *a: (solved_s.append(clock[0]), clock.__setitem__(0, clock[0] + 0.5), inner(*a))[-1],
    )
    monkeypatch.setattr(module.time, "perf_counter", lambda: clock[0])
    drawn.solve(r.commands)  # takes half a second
    fields = r.technique.fields
    for frame in range(31):  # a drag for three seconds
        clock[0] = 10.0 + 0.1 * frame
        light = r.scene.lights[0]
        x, y, z = light.position
        drawn.give(replace(r.scene, lights=(light.changed("position", (x + 0.01, y, z)),)))
        drawn.solve(r.commands, is_quick=True)
    assert r.technique.fields.irradiance is not None
    assert fields.irradiance is not None
    # A fifth of the time is the lattice's: once within two seconds and a half.
    assert len(solved_s) == 2
    assert solved_s[1] == pytest.approx(12.0, abs=0.11)
    drawn.solve(r.commands)  # the hand rests
    assert len(solved_s) == 3
    drawn.close()


def test_nested_lattices_follow_the_camera():
    drawn = drawn_with(cascades=2)
    scene = drawn.renderer.scene
    assert solved(drawn, scene) == 1
    assert solved(drawn, scene) == 0
    assert solved(drawn, moved(scene)) == 1
    drawn.close()
