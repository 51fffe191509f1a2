"""The arrays behind an OBJ file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from airlight.scene.io.obj_parse import parse_obj

PATH = Path("a.obj")


def test_random_faces_come_back_as_written():
    """A file of mixed corner styles and polygon sizes, against a plain reader."""
    rng = np.random.default_rng(7)
    lines = [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in rng.normal(size=(50, 3))]
    lines += [f"vt {u:.4f} {v:.4f}" for u, v in rng.random((40, 2))]
    lines += [f"vn {x:.5f} {y:.5f} {z:.5f}" for x, y, z in rng.normal(size=(30, 3))]
    expected = []
    for _ in range(200):
        style, words = int(rng.integers(4)), []
        for _ in range(int(rng.integers(3, 7))):
            p, t, n = (int(rng.integers(1, top)) for top in (51, 41, 31))
            words.append([f"{p}", f"{p}/{t}", f"{p}//{n}", f"{p}/{t}/{n}"][style])
            expected.append((p - 1, t - 1 if style in (1, 3) else -1, n - 1 if style > 1 else -1))
        lines.append("f " + " ".join(words))
    data = parse_obj("\n".join(lines).encode(), PATH)
    np.testing.assert_array_equal(data.corners, expected)
    assert data.sizes.sum() == len(expected)
    assert data.lines[0] == 121


def test_statements_hold_from_their_line_on():
    text = "mtllib a b.mtl\nv 0 0 0\nF\nusemtl x\ns 1\nF\ns off\nF\nusemtl y\nF"
    data = parse_obj(text.replace("F", "f 1 1 1").encode(), PATH)
    assert data.libraries == ("a b.mtl",)
    assert [data.material_names[k] for k in data.material] == ["", "x", "x", "y"]
    assert data.is_flat.tolist() == [False, False, True, True]


def test_a_weight_after_the_position_and_a_short_texture_coordinate():
    data = parse_obj(b"v 1 2 3 1.0\nv 4 5 6\nvt 0.5\nvt 0.25 0.75 0\nf 1 2 1\n", PATH)
    np.testing.assert_array_equal(data.positions, [[1, 2, 3], [4, 5, 6]])
    np.testing.assert_array_equal(data.uvs, [[0.5, 0], [0.25, 0.75]])
    assert data.colors is None
