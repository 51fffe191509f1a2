"""Tables of colours in .cube files: read, looked up, and refused."""

from __future__ import annotations

import itertools

import numpy as np
import PIL.Image
import pytest

from airlight.app import cli
from airlight.errors import SceneError
from airlight.scene.image import Image
from airlight.scene.io.cube import read_cube

RAMP = np.linspace(0.0, 1.0, 96, dtype=np.float32).reshape(4, 8, 3)


def cube_text(function, size=5, low=(0, 0, 0), high=(1, 1, 1)):
    """A table of a function of colours, as applications write it: red changes fastest."""
    axes = [np.linspace(low[c], high[c], size) for c in range(3)]
    rows = [function(r, g, b) for b, g, r in itertools.product(axes[2], axes[1], axes[0])]
    head = ["# by a test", 'TITLE "a test"', f"LUT_3D_SIZE {size}"]
    head += [f"DOMAIN_MIN {low[0]} {low[1]} {low[2]}", f"DOMAIN_MAX {high[0]} {high[1]} {high[2]}"]
    return "\n".join([*head, "", *(" ".join(f"{v:.9f}" for v in row) for row in rows)])


def affine(r, g, b):
    """What blending between entries keeps exactly; every channel goes elsewhere."""
    return (0.2 + 0.5 * g, 0.9 - 0.3 * r * 1.0 - 0.1 * b, 0.1 * r + 0.2 * g + 0.3 * b)


def test_a_table_is_blended_between_its_entries_and_held_beyond(tmp_path):
    (tmp_path / "a.cube").write_text(cube_text(affine, low=(-0.5, 0, 0), high=(1, 2, 1)))
    lut = read_cube(tmp_path / "a.cube")
    colours = np.random.default_rng(3).uniform((-0.5, 0, 0), (1, 2, 1), (50, 3))
    expected = np.array([affine(*colour) for colour in colours])
    np.testing.assert_allclose(lut.applied(colours), expected, atol=1e-8)
    np.testing.assert_allclose(lut.applied(np.array([[9, -9, 9.0]])), [affine(1, 0, 1)], atol=1e-8)


def test_a_table_of_one_dimension_has_a_curve_for_each_channel(tmp_path):
    text = "LUT_1D_SIZE 3\nLUT_1D_INPUT_RANGE 0 2\n0 1 0\n1 0 0.5\n0 1 1\n"
    (tmp_path / "a.cube").write_text(text)
    lut = read_cube(tmp_path / "a.cube")
    np.testing.assert_allclose(lut.applied(np.array([0.5, 1.0, 1.5])), [0.5, 0.0, 0.75])


def test_an_image_is_graded_where_it_is_displayed(tmp_path):
    (tmp_path / "negative.cube").write_text(cube_text(lambda r, g, b: (1 - r, 1 - g, 1 - b), 2))
    image = Image(RAMP)
    plain = image.display().astype(int)
    graded = image.graded(tmp_path / "negative.cube")
    # Dither of half a code and rounding, on both.
    assert np.abs(255 - plain - graded.display()).max() <= 2
    image.save(tmp_path / "a.exr")
    words = ["convert", str(tmp_path / "a.exr"), str(tmp_path / "a.png")]
    assert cli.run([*words, "--lut", str(tmp_path / "negative.cube")]) == 0
    np.testing.assert_array_equal(PIL.Image.open(tmp_path / "a.png"), graded.display())


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0 0 0\n1 1 1\n", "no LUT_1D_SIZE or LUT_3D_SIZE"),
        ("LUT_3D_SIZE 2\n0 0 0\n1 1 1\n", "means 8 colours; it has 2"),
        ("LUT_3D_SIZE 1\n0 0 0\n", "line 1: 'LUT_3D_SIZE 1' is no size from 2 to 256"),
        ("LUT_1D_SIZE 2\n0 0 0\n1 1 nan\n", "line 3: '1 1 nan' is not 3 numbers"),
        ("LUT_1D_SIZE 2\nDOMAIN_MAX 0 1 1\n0 0 0\n1 1 1\n", "DOMAIN_MAX is not above DOMAIN_MIN"),
        ("<html>\n", "line 1: '<html>' is not 3 numbers"),
    ],
)
def test_what_is_no_table_is_refused_by_its_line(tmp_path, text, message, capsys):
    path = tmp_path / "a.cube"
    path.write_text(text)
    with pytest.raises(SceneError, match=message.replace("(", r"\(")):
        read_cube(path)
    words = ["render", "builtin:cornell", "-o", str(tmp_path / "a.png"), "--lut"]
    assert cli.run([*words, str(path)]) == 2
    assert message in capsys.readouterr().err
    assert cli.run([*words, str(tmp_path / "none.cube")]) == 2
    assert "none.cube" in capsys.readouterr().err
    assert not (tmp_path / "a.png").exists()
