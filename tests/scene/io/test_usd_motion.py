"""What moves in a USD stage: places of meshes, lights, cameras; and what is static, told."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.io import load, load_meshes

pytestmark = pytest.mark.needs("usd_core")
HEAD = "metersPerUnit = 1\ntimeCodesPerSecond = 10\nstartTimeCode = 1\nendTimeCode = 21"
QUAD = """
def Mesh "quad"
{
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    uniform token subdivisionScheme = "none"
    %s
}
"""
TURNING = """
    double xformOp:rotateY.timeSamples = { 1: 0, 21: 720 }
    uniform token[] xformOpOrder = ["xformOp:rotateY"]
"""
SLIDING = """
    double3 xformOp:translate.timeSamples = { 1: (0, 0, 0), 11: (10, 0, 0) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
"""


def stage(folder, text: str, head: str = HEAD):
    (folder / "a.usda").write_text(f"#usda 1.0\n(\n{head}\n)\n{text}")
    return folder / "a.usda"


def xform(name: str, body: str) -> str:
    return f'def Xform "{name}"\n{{\n{body}\n}}\n'


def usd_world(path, prim: str, code: float, unit: float = 1.0):
    from pxr import Usd, UsdGeom

    opened = Usd.Stage.Open(str(path))
    matrix = UsdGeom.XformCache(code).GetLocalToWorldTransform(opened.GetPrimAtPath(prim))
    return np.diag([unit] * 3 + [1.0]) @ np.array(matrix).T


def test_meshes_go_as_usd_has_them(tmp_path):
    path = stage(tmp_path, xform("a", SLIDING + xform("b", TURNING + QUAD % "")) + QUAD % "")
    scene = load_meshes(path)
    assert scene.warnings == () and scene.animation.last_s == pytest.approx(2.0)
    for code in (1.0, 3.7, 6.0, 11.0, 15.25, 21.0):
        moving, still = scene.at((code - 1.0) / 10.0).meshes
        expected = usd_world(path, "/a/b/quad", code)
        # Within a frame, a chord of a turn of 36 degrees is a turn still.
        np.testing.assert_allclose(moving.world_from_object, expected, atol=1e-6)
        np.testing.assert_array_equal(still.world_from_object, np.eye(4))


def test_units_mirrors_and_scales_stay(tmp_path):
    body = """
    double3 xformOp:scale.timeSamples = { 1: (1, 2, -3), 11: (3, 2, -1) }
    double3 xformOp:rotateXYZ = (20, 30, 40)
    uniform token[] xformOpOrder = ["xformOp:rotateXYZ", "xformOp:scale"]
    """
    path = stage(tmp_path, xform("a", body + QUAD % ""), HEAD.replace("= 1\nt", "= 0.01\nt"))
    scene = load_meshes(path)
    for code in (1.0, 6.0, 11.0):
        (mesh,) = scene.at((code - 1.0) / 10.0).meshes
        expected = usd_world(path, "/a/quad", code, 0.01)
        np.testing.assert_allclose(mesh.world_from_object, expected, atol=1e-8)


def test_a_stack_that_is_reset_is_not_moved_by_what_is_around(tmp_path):
    alone = 'uniform token[] xformOpOrder = ["!resetXformStack!"]'
    scene = load_meshes(stage(tmp_path, xform("a", SLIDING + QUAD % alone)))
    assert scene.animation is None


def test_lights_and_the_camera_go_along(tmp_path):
    parts = """
    def SphereLight "l" { float inputs:radius = 0.5 }
    def Camera "c" { }
    """.replace("{ ", "{\n").replace(" }", "\n}")
    scene = load_meshes(stage(tmp_path, xform("a", SLIDING + parts) + QUAD % ""))
    for time, x in ((0.0, 0.0), (0.5, 5.0), (2.0, 10.0)):
        now = scene.at(time)
        assert now.lights[0].position == pytest.approx((x, 0, 0))
        assert now.lights[0].radius == 0.5
        assert now.camera.position == pytest.approx((x, 0, 0))
        assert now.meshes[0].world_from_object[0, 3] == 0


def test_a_scene_file_places_what_moves(tmp_path):
    stage(tmp_path, xform("a", SLIDING + QUAD % ""))
    (tmp_path / "b.toml").write_text(
        '[[mesh]]\nfile = "a.usda"\ntranslate = [0, 3, 0]\nscale = 2\nclip_speed = 0.5\n'
    )
    (mesh,) = load(tmp_path / "b.toml").at(1.0).meshes
    np.testing.assert_allclose(mesh.world_from_object[:3, 3], (10, 3, 0), atol=1e-9)


def test_a_light_that_is_scaled_from_nothing_stays(tmp_path):
    body = """
    float3 xformOp:scale.timeSamples = { 1: (0, 0, 0), 10: (1, 1, 1) }
    uniform token[] xformOpOrder = ["xformOp:scale"]
    def SphereLight "light"
    {
        float inputs:intensity = 3
    }
    """
    scene = load_meshes(stage(tmp_path, xform("a", body) + QUAD % ""))
    assert len(scene.lights) == 1
    assert any("scaled to nothing" in text for text in scene.warnings)


def test_what_cannot_move_is_told(tmp_path):
    dome = 'def DomeLight "d"\n{\n}\n'
    scene = load_meshes(stage(tmp_path, xform("a", TURNING + dome) + QUAD % ""))
    assert any("'/a/d': a DomeLight that moves is static" in t for t in scene.warnings)
    assert scene.animation is None
    skewed = """
    matrix4d xformOp:transform.timeSamples = {
        1: ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)),
        5: ((1, 1, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
    }
    uniform token[] xformOpOrder = ["xformOp:transform"]
    """
    scene = load_meshes(stage(tmp_path, xform("a", skewed + QUAD % "")))
    assert any("'/a': its motion shears, which is left out" in t for t in scene.warnings)
