"""Moving scenes: a scene as a function of time, `scene.at(time_s)`.

   keyframes, a file's nodes, files of grids -> tracks -> animation -> Scene.at(time_s): a Scene

   animation    the tracks of a scene, their span and rate
   curve        a value by keyframes
   tracks       cameras, lights, meshes and environments by keyframes
   density      volumes by a function of time; file_sequence by files; boxes   several on one
   rig, skin    the nodes, skins and morph targets of a glTF file, and the vertices they move

Every track computes what it moves from its own data and the time alone, so a scene at a time
does not depend on what was asked before.
"""

from .animation import Animation, Track
from .curve import Curve

__all__ = ["Animation", "Curve", "Track"]
