"""Tangents of glTF files: told where normal maps would lie otherwise by them."""

from __future__ import annotations

import base64
import io

import numpy as np
import PIL.Image
import pytest

from airlight.scene.io.gltf import load_gltf

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]


def told(draft, tangent, uvs, *, has_map=True):
    """The warnings of a square with a normal map and one tangent (4,) for all of it."""
    held = io.BytesIO()
    PIL.Image.new("RGB", (2, 2), (128, 128, 255)).save(held, "png")
    data = "data:image/png;base64," + base64.b64encode(held.getvalue()).decode()
    draft.json["images"], draft.json["textures"] = [{"uri": data}], [{"source": 0}]
    draft.json["materials"] = [{"normalTexture": {"index": 0}} if has_map else {}]
    attributes = {
        "POSITION": draft.array(SQUARE, "f4"),
        "NORMAL": draft.array([(0, 0, 1)] * 4, "f4"),
        "TEXCOORD_0": draft.array(uvs, "f4"),
        "TANGENT": draft.array([tangent] * 4, "f4"),
    }
    indices = draft.array([0, 1, 2, 0, 2, 3], "u1")
    primitive = {"attributes": attributes, "indices": indices, "material": 0}
    return [w for w in load_gltf(draft.single(primitive).glb()).warnings if "TANGENT" in w]


UPRIGHT = [(0, 1), (1, 1), (1, 0), (0, 0)]
TURNED = [(0, 0), (0, 1), (1, 1), (1, 0)]  # u goes up the square
MIRRORED = [(1, 1), (0, 1), (0, 0), (1, 0)]


@pytest.mark.parametrize(
    ("tangent", "uvs"),
    [((1, 0, 0, 1), UPRIGHT), ((0, 1, 0, 1), TURNED), ((-1, 0, 0, -1), MIRRORED),
     ((1, 0.2, 0.5, 1), UPRIGHT), ((0, 0, 0, 1), UPRIGHT)],
)  # fmt: skip
def test_tangents_along_u_are_no_loss(draft, tangent, uvs):
    assert told(draft, tangent, uvs) == []


@pytest.mark.parametrize(
    ("tangent", "uvs"),
    [((0, 1, 0, 1), UPRIGHT), ((1, 0, 0, 1), MIRRORED), ((1, 0.5, 0, 1), UPRIGHT)],
)
def test_others_are_told_where_there_is_a_normal_map(draft, tangent, uvs):
    (text,) = told(draft, tangent, uvs)
    assert "points elsewhere on 100 % of its surface" in text
    assert told(draft, tangent, uvs, has_map=False) == []


def test_uvs_that_say_nothing_are_no_loss(draft):
    assert told(draft, (1, 0, 0, 1), np.zeros((4, 2))) == []
