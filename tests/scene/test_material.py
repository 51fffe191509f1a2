"""Material and texture: ranges of every factor."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import Material, Texture


def test_only_emission_makes_a_material_emissive():
    assert not Material(base_color=1.0).is_emissive
    assert Material(emission=(0, 0, 0.1)).is_emissive


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"base_color": 1.1}, r"base_color = \[1\.1, 1\.1, 1\.1\] is above 1"),
        ({"roughness": -0.1}, r"roughness = -0\.1 is outside \[0, 1\]"),
        ({"metallic": 2}, r"metallic = 2 is outside \[0, 1\]"),
        ({"alpha_cutoff": 2}, r"alpha_cutoff = 2 is outside \[0, 1\]"),
        ({"emission": -1}, "emission = .* is negative"),
        ({"two_sided": 1}, "two_sided must be true or false, not 1"),
    ],
)
def test_impossible_materials_are_refused(values, expected):
    with pytest.raises(SceneError, match=expected):
        Material(**values)


def test_a_texture_is_rgba_and_not_empty():
    assert not Texture(np.zeros((1, 1, 4), np.uint8)).pixels.flags.writeable
    with pytest.raises(SceneError, match=r"texture wood\.png has shape \(1, 1, 3\)"):
        Texture(np.zeros((1, 1, 3), np.uint8), source="wood.png")
    with pytest.raises(SceneError, match=r"wood\.png: texture has no pixels"):
        Texture(np.zeros((0, 1, 4), np.uint8), source="wood.png")
