"""meshopt streams that the reference encoder wrote (meshoptimizer 0.25 for JavaScript)."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import numpy as np
import pytest

from airlight.scene.io import meshopt
from airlight.scene.io.meshopt import MeshoptError

STREAMS = json.loads((Path(__file__).parent / "meshopt_streams.json").read_text())
SIDE = 23
COUNT = 60
K = np.arange(COUNT)
WAVES = np.stack([np.sin(K), np.cos(K * 1.7), np.sin(K * 0.3 + 1), np.cos(K * 2.2)], axis=1)


def stream(name: str) -> bytes:
    return base64.b64decode(STREAMS[name]["data"])


def grid() -> np.ndarray:
    """The triangles (T, 3) of the grid that was encoded."""
    y, x = np.mgrid[: SIDE - 1, : SIDE - 1]
    a = (y * SIDE + x).reshape(-1)
    two = np.stack([a, a + 1, a + SIDE, a + 1, a + SIDE + 1, a + SIDE], axis=1)
    return two.reshape(-1, 3)


def random_indices() -> np.ndarray:
    state, out = 12345, []
    for _ in range(900):
        state = (state * 1103515245 + 12345) & 0x7FFFFFFF
        out.append((state >> 8) % 5000)
    return np.array(out)


def turned(triangles: np.ndarray) -> np.ndarray:
    """Each triangle (T, 3) from its smallest corner on: a stream may begin at any corner."""
    first = triangles.argmin(axis=1)
    return np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)


def filtered(name: str, kind: str) -> np.ndarray:
    found = STREAMS[name]
    rows = meshopt.decode_attributes(stream(name), found["count"], found["stride"])
    return meshopt.unfiltered(rows, kind)


def test_attributes():
    rows = meshopt.decode_attributes(stream("attributes"), SIDE * SIDE, 8).view("<i2")
    y, x = np.mgrid[:SIDE, :SIDE].reshape(2, -1)
    height = np.floor(500 * np.sin(x * 0.7) * np.cos(y) + 0.5)
    expected = np.stack([x * 37 - y * 3, height, y * 41, 0 * x], axis=1)
    np.testing.assert_array_equal(rows, expected)


def test_triangles_of_a_grid():
    found = meshopt.decode_triangles(stream("triangles"), grid().size).reshape(-1, 3)
    np.testing.assert_array_equal(turned(found), turned(grid()))


def test_triangles_in_another_order_are_the_same_grid():
    found = meshopt.decode_triangles(stream("reordered"), grid().size).reshape(-1, 3)
    # Vertices are renumbered: each has as many triangles around it as before.
    around = [np.sort(np.bincount(t.reshape(-1))) for t in (found, grid())]
    np.testing.assert_array_equal(*around)


@pytest.mark.parametrize("mode", ["triangles", "indices"])
def test_indices_without_any_order(mode):
    expected = random_indices()
    if mode == "indices":
        found = meshopt.decode_indices(stream("indices"), len(expected))
        np.testing.assert_array_equal(found, expected)
    else:
        found = meshopt.decode_triangles(stream("random"), len(expected)).reshape(-1, 3)
        np.testing.assert_array_equal(turned(found), turned(expected.reshape(-1, 3)))


@pytest.mark.parametrize(
    "name, dtype, tolerance", [("octa8", np.int8, 0.0176), ("octa16", "<i2", 0.0009)]
)
def test_octahedral_normals(name, dtype, tolerance):
    # Half a step of 8 or 12 bits in x and y, so a step in z, stretched by sqrt(3); and rounding.
    vectors = WAVES[:, :3] / np.linalg.norm(WAVES[:, :3], axis=1, keepdims=True)
    found = filtered(name, "OCTAHEDRAL").view(dtype)[:, :3].astype(float)
    np.testing.assert_allclose(found / np.iinfo(dtype).max, vectors, atol=tolerance)


def test_quaternions():
    expected = WAVES / np.linalg.norm(WAVES, axis=1, keepdims=True)
    found = filtered("quat", "QUATERNION").view("<i2") / 32767.0
    sign = np.sign((found * expected).sum(axis=1, keepdims=True))
    # 12 bits of a component of at most sqrt(1/2).
    np.testing.assert_allclose(found * sign, expected, atol=0.0005)


def test_exponential_floats():
    vectors = WAVES[:, :3] / np.linalg.norm(WAVES[:, :3], axis=1, keepdims=True)
    found = filtered("exp", "EXPONENTIAL").view("<f4")
    # 15 bits of an exponent that a vector's components share: 17 / 2^14.
    np.testing.assert_allclose(found[:, :3], vectors * 17.0, atol=17.0 / 2**14)


@pytest.mark.parametrize("name", list(STREAMS))
def test_every_cut_is_an_error_or_decodes(name):
    """Never an IndexError, never a hang."""
    whole, found = stream(name), STREAMS[name]
    for end in range(0, len(whole), 7):
        for decode in (meshopt.decode_triangles, meshopt.decode_indices):
            with pytest.raises(MeshoptError) if end < 5 else _either():
                decode(whole[:end], found["count"])
        with pytest.raises(MeshoptError) if end < 33 else _either():
            meshopt.decode_attributes(whole[:end], found["count"], max(found["stride"], 4))


class _either:
    """Passes where MeshoptError is raised, and where nothing is."""

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        return kind is not None and issubclass(kind, MeshoptError)


def test_unknown_filters_and_strides_are_named():
    with pytest.raises(MeshoptError, match="filter COLOR"):
        meshopt.unfiltered(np.zeros((2, 8), np.uint8), "COLOR")
    with pytest.raises(MeshoptError, match="byteStride 6"):
        meshopt.decode_attributes(stream("attributes"), 4, 6)
    with pytest.raises(MeshoptError, match="begins with 0xa1"):
        meshopt.decode_attributes(b"\xa1" + stream("attributes")[1:], 4, 8)
