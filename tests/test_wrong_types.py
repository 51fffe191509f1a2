"""Values of types that cannot be, at each door of the Python API: one message, no traceback."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import airlight as al
from airlight.scene import shapes

CUBE = al.Mesh(shapes.box())
SCENE = al.Scene(meshes=(CUBE,))
ONES = np.ones((4, 4, 4), np.float32)


def refused(wrong, *words):
    """`wrong()` raises an error of airlight's, of one line that has these words."""
    with pytest.raises(al.AirlightError) as caught:
        wrong()
    text = str(caught.value)
    assert len(text.splitlines()) == 1
    for word in words:
        assert word in text


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("meshes", CUBE, "sequence of Mesh"),
        ("meshes", ("cube",), "each of the scene's meshes must be of type Mesh, not 'cube'"),
        ("meshes", "cube", "sequence of Mesh"),
        ("lights", ["sun"], "must be of type Light, not 'sun'"),
        ("volumes", (ONES,), "must be of type Volume"),
        ("light_groups", (1,), "must be of type PointLights"),
        ("camera", None, "the scene's camera must be of type Camera, not None"),
        ("environment", "blue", "must be of type Environment"),
        ("medium", 0.5, "must be of type Medium, not 0.5"),
    ],
)
def test_a_scene_says_what_its_fields_hold(field, value, words):
    refused(lambda: al.Scene(**{field: value}), words)


def test_lists_of_the_right_type_will_do():
    scene = al.Scene(meshes=[CUBE], lights=iter([al.DirectionalLight((0, -1, 0), (1, 1, 1))]))
    assert scene.meshes == (CUBE,)
    assert len(scene.lights) == 1
    # A tuple stays the same object, by which a renderer knows that nothing moved.
    assert dataclasses.replace(scene, name="again").meshes is scene.meshes


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda: al.Mesh("cube.obj"), "geometry of mesh '' must be of type Geometry"),
        (lambda: al.Mesh(CUBE.geometry, "red"), "must be of type Material, not 'red'"),
        (lambda: al.Material(normal_texture="n.png"), "normal_texture must be of type Texture"),
        (lambda: al.Geometry(np.eye(3), [[0.5, 1, 2]]), "indices must be whole numbers"),
        (lambda: al.Geometry(np.eye(3), [["a", 1, 2]]), "must be an array of real numbers"),
        (lambda: al.Geometry([["a"] * 3] * 3, [[0, 1, 2]]), "vertex positions must be an array"),
        (lambda: al.Geometry([[0, 0, 0], [1]], [[0, 1, 2]]), "vertex positions must be an array"),
        (lambda: al.Volume(sigma_t=1.0, density=ONES + 1j), "density must be an array of real"),
        (lambda: al.Volume(sigma_t=1.0, density=[[["a"]]]), "density must be an array of real"),
    ],
)
def test_parts_of_scenes_say_what_they_are_made_of(wrong, words):
    refused(wrong, words)


@pytest.mark.parametrize("numbers", [[[0, 1, 2]], [[0.0, 1.0, 2.0]], np.uint8([[0, 1, 2]])])
def test_whole_numbers_of_any_type_are_indices(numbers):
    assert al.Geometry(np.eye(3), numbers).indices.tolist() == [[0, 1, 2]]


@pytest.mark.parametrize("value", [3, None, ["a.toml"]])
def test_what_is_no_path_is_no_scene_and_no_image(value):
    refused(lambda: al.load(value), "must be a path")
    refused(lambda: al.render(value), "must be a path")
    refused(lambda: al.with_defaults(value), "must be of type Scene")
    black = al.Image(np.zeros((2, 2, 3), np.float32))
    refused(lambda: black.save(value), "an image is saved to a path")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"samples": "4"}, "samples must be a whole number, not '4'"),
        ({"samples": 2.5}, "samples must be a whole number, not 2.5"),
        ({"samples": True}, "samples must be a whole number"),
        ({"samples": 0}, "samples = 0 is out of range"),
        ({"size": 8}, "size must be two whole numbers, not 8"),
        ({"size": (8.0, 8)}, "size must be two whole numbers"),
        ({"technique": 3}, "unknown technique '3'"),
        ({"settings": ["bounces"]}, "settings must be a mapping"),
        ({"time": float("nan")}, "time_s is nan"),
        ({"progress": 3}, "progress must be a function, not 3"),
    ],
)
def test_render_says_what_its_arguments_are(options, words):
    refused(lambda: al.render(SCENE, **{"size": (8, 8), "technique": "direct", **options}), words)


def test_frames_say_so_too_and_the_renderer_goes_on():
    with al.Renderer(SCENE, "direct", (8, 8)) as renderer:
        refused(lambda: renderer.frame(camera="here"), "camera must be of type Camera")
        refused(lambda: renderer.frame(meshes=CUBE), "meshes")
        refused(lambda: renderer.frame(samples=0), "samples = 0")
        refused(lambda: renderer.frame(time="now"), "time_s must be a number")
        refused(lambda: renderer.frame(progress="yes"), "progress must be a function")
        assert renderer.frame() is not None


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda image: al.reference.compare(image, 3), "the reference must be of type Image"),
        (lambda image: al.reference.compare("a.exr", image), "the image must be of type Image"),
        (lambda _: al.reference.render("a.toml"), "must be of type Scene, not 'a.toml'"),
        (lambda _: al.reference.render(SCENE, size=8), "size must be two whole numbers"),
        (lambda _: al.reference.render(SCENE, spp="64"), "spp must be a whole number, not '64'"),
        (lambda _: al.reference.render(SCENE, layers=("x",)), "unknown reference layer 'x'"),
        (lambda _: al.reference.render(SCENE, progress=3), "progress must be a function"),
    ],
)
def test_references_say_what_they_are_given(wrong, words):
    black = al.Image(np.zeros((2, 2, 3), np.float32))
    refused(lambda: wrong(black), words)
