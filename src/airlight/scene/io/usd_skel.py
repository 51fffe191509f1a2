"""Skeletons of a USD stage (UsdSkel): skinned meshes and blend shapes in one pose."""

from __future__ import annotations

from typing import Any

_MOVING = ("translations", "rotations", "scales", "blendShapeWeights")


def pose(stage: Any, time: Any) -> None:
    """Give each mesh that a skeleton moves the points that it has at `time`.

    They lie over the stage's own, in its session layer; files stay as they are. Meshes that cannot
    be posed, as those of instances, keep their own.
    """
    from pxr import Gf, Tf, UsdSkel

    roots = [prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Root)]
    if not roots:
        return
    # OpenUSD's own skinning, written beside the stage's layers.
    stage.SetEditTarget(stage.GetSessionLayer())
    try:
        UsdSkel.BakeSkinning(stage.Traverse(), Gf.Interval(_frame(stage, time)))
    except Tf.ErrorException:
        return  # whose meshes have no points of their own are told as standing at rest
    finally:
        stage.SetEditTarget(stage.GetRootLayer())


def is_posed(prim: Any) -> bool:
    """Whether `pose` gave the mesh its points."""
    layer = prim.GetStage().GetSessionLayer()
    return layer.GetAttributeAtPath(prim.GetPath().AppendProperty("points")) is not None


def _frame(stage: Any, time: Any) -> float:
    """The number of a time code; of the earliest time that of the first pose."""
    from pxr import UsdSkel

    if not time.IsEarliestTime():
        return float(time.GetValue())
    animations = (prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Animation))
    attributes = (prim.GetAttribute(name) for prim in animations for name in _MOVING)
    return min((t for a in attributes if a for t in a.GetTimeSamples()[:1]), default=0.0)
