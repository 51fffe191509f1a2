"""Shader functions that read a medium's parameters, beside their NumPy twins."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from airlight.gpu.memory import Buffer, buffer_of
from airlight.gpu.slots import storage, uniform
from airlight.maths.medium import transmittance_in_box
from airlight.maths.outgoing_light import arriving
from airlight.maths.sampling import fibonacci_sphere
from airlight.pop.medium.placement import MediumParams, MediumPlacement
from airlight.pop.medium.surrounding import SurroundingMedium

RNG = np.random.default_rng(11)
COUNT = (7, 6, 5)
CELL = np.array([0.5, 0.4, 0.45])
CELLS = int(np.prod(COUNT))


def params(**given: Any) -> MediumParams:
    """The parameters of a medium, 0 where nothing is given."""
    zeros = {name: np.zeros(field.shape) for name, field in MediumParams.fields.items()}
    return MediumParams(**(zeros | {"count": COUNT, "cells": CELLS, "cell": CELL} | given))


@pytest.fixture
def called(kernel, gpu, commands):
    """called(library, call, params, a=array, ...) -> vec3f for each row of the arrays (N, 4)."""

    def evaluate(library: str, call: str, values: MediumParams, **rows: np.ndarray) -> np.ndarray:
        slots = (
            uniform("params", MediumParams),
            *(storage(name, "vec4f") for name in rows),
            storage("result", "vec4f", "read_write"),
        )
        text = (
            f"//! use {library}\n@compute @workgroup_size(WX, WY, WZ) "
            "fn main(@builtin(global_invocation_id) id: vec3u) {\n"
            f"if (id.x < arrayLength(&result)) {{ result[id.x] = vec4f({call}, 0.0); }} }}"
        )
        count = len(rows["travel"])
        result = Buffer(gpu, "result", 16 * count)
        bound = {name: buffer_of(gpu, name, a.astype(np.float32)) for name, a in rows.items()}
        kernel(text, slots).dispatch(commands, (count,), params=values, result=result, **bound)
        commands.submit()
        return np.asarray(result.read().reshape(count, 4)[:, :3].astype(np.float64))

    return evaluate


def four(rows: np.ndarray) -> np.ndarray:
    """(N, 3) as the vec4f of a buffer."""
    return np.concatenate([rows, np.zeros((len(rows), 1))], axis=1)


def test_light_arrives_past_walls_as_its_twin(called):
    """A third of the faces are closed, so most paths end at one, some of them across an edge."""
    shape = COUNT[::-1]
    source, extinction = RNG.uniform(0.0, 2.0, (*shape, 3)), RNG.uniform(0.1, 1.5, (*shape, 3))
    travel = RNG.permutation(fibonacci_sphere(CELLS))
    closed = RNG.uniform(size=(3, *shape)) < 0.3
    # The last cells of an axis have no next one.
    closed[0, :, :, -1] = closed[1, :, -1] = closed[2, -1] = False
    faces = np.zeros(shape, np.int64)
    for axis in range(3):
        faces += closed[axis] << (2 * axis + 1)
        faces += np.roll(closed[axis], 1, axis=2 - axis) << (2 * axis)
    sections = np.zeros((6, CELLS, 4))
    sections[4, :, :3] = source.reshape(-1, 3)
    sections[5] = np.concatenate([extinction, faces[..., None]], axis=-1).reshape(-1, 4)
    got = called(
        "arriving_light",
        "arriving(id.x, travel[id.x].xyz)",
        params(),
        travel=four(travel),
        diffuse=sections.reshape(-1, 4),
    )
    want, through = (
        arriving(source, extinction, travel.reshape(*shape, 3), CELL, walls).reshape(-1, 3)
        for walls in (closed, None)
    )
    np.testing.assert_allclose(got, want, rtol=1e-4, atol=1e-5)
    assert (np.abs(want - through).max(axis=1) > 1e-3).mean() > 0.5


def test_a_surrounding_medium_attenuates_as_its_twin(called):
    low, high, sigma_t = np.array([-2.0, -1.0, -3.0]), np.array([3.0, 2.0, 1.0]), (0.2, 0.5, 0.0)
    to_world = np.eye(4)
    to_world[:3] = [[0.0, -1.0, 0.0, 0.5], [0.8, 0.0, -0.6, -0.5], [0.6, 0.0, 0.8, -1.0]]
    placement = MediumPlacement(to_world, np.eye(4), CELL * COUNT, COUNT)
    point, travel = RNG.uniform(-3.0, 4.0, (200, 3)), fibonacci_sphere(200)
    distance = RNG.uniform(0.0, 8.0, 200)
    around = SurroundingMedium(tuple(low), tuple(high), sigma_t)
    got = called(
        "surrounding_medium",
        "passed_surrounding(point[id.x].xyz, travel[id.x].xyz, point[id.x].w)",
        params(**around.fields(placement)),
        point=np.concatenate([point, distance[:, None]], axis=1),
        travel=four(travel),
    )
    world, along = point @ to_world[:3, :3].T + to_world[:3, 3], travel @ to_world[:3, :3].T
    want = transmittance_in_box(sigma_t, world, -along, distance, low, high)
    np.testing.assert_allclose(got, want, rtol=1e-4, atol=1e-6)
    assert 0.2 < (want[:, 1] < 1.0).mean() < 0.95
