"""[[volume]] tables: where a volume stands, and what its file says of that."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io import load

HEAD = "[environment]\nradiance = 1\n"


def volumes(tmp_path, text: str):
    (tmp_path / "a.toml").write_text(HEAD + text)
    return load(tmp_path / "a.toml").volumes


def test_several_volumes_stand_each_in_its_own_place(tmp_path):
    np.save(tmp_path / "smoke.npy", np.ones((2, 2, 2), np.float32))
    one, two = volumes(
        tmp_path,
        """
[[volume]]
file = "smoke.npy"
sigma_t = 2
detail = 0.5
translate = [1, 2, 3]
rotate_deg = [0, 90, 0]
scale = 2
[[volume]]
shape = "sphere"
sigma_s = [1, 2, 3]
sigma_a = 1
g = 0.9
matrix = [1, 0, 0, 4,  0, 1, 0, 5,  0, 0, 1, 6,  0, 0, 0, 1]
""",
    )
    want = [[0, 0, 2, 1], [0, 2, 0, 2], [-2, 0, 0, 3], [0, 0, 0, 1]]
    np.testing.assert_allclose(one.world_from_volume, want, atol=1e-12)
    assert one.detail == 0.5
    np.testing.assert_allclose(two.world_from_volume[:3, 3], (4, 5, 6))
    assert (two.sigma_t, two.g) == ((2.0, 3.0, 4.0), (0.9,) * 3)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("shape = 'box'", "[[volume]] 1 has no sigma_t. Use sigma_t and albedo, or sigma_s and"),
        ("shape = 'box'\nsigma_t = [1, 2]", "[[volume]] 1: sigma_t must be three numbers"),
        ("shape = 'box'\nsigma_t = 1\ng = 1", "[[volume]] 1: g = [1.0, 1.0, 1.0] must lie in (-1"),
        ("shape = 'box'\nsigma_t = -1", "[[volume]] 1: sigma_t = [-1.0, -1.0, -1.0] is negative"),
        ("shape = 'box'\nsigma_t = nan", "[[volume]] 1: sigma_t is nan, it must be finite"),
        ("shape = 'box'\nsigma_t = 1\ndetail = -1", "detail = -1 is outside [0, 10]"),
        ("shape = 'box'\nsigma_t = 1\ngrid = 'a'", "grid belongs to a file, not to a shape"),
    ],
)
def test_a_mistake_is_named_by_its_key(tmp_path, text, problem):
    with pytest.raises(SceneError) as caught:
        volumes(tmp_path, f"[[volume]]\n{text}\n")
    assert problem in str(caught.value)
