"""What is to be rendered: frozen values, no GPU.

scene        everything in one value        camera, lights, environment   what sees, what shines
mesh         triangles and their places     material                      how they reflect
point_lights thousands of lights in arrays
medium       homogeneous air                volume                        smoke, clouds, any density
image        a rendered image             settings                      a technique's knobs
io/          files <-> these                builtin/                      scenes that ship
"""

from .camera import Camera
from .environment import Environment
from .lights import AreaLight, DirectionalLight, Light, PointLight, SpotLight
from .material import Material, Texture
from .medium import Medium
from .mesh import Geometry, Mesh
from .point_lights import PointLights
from .scene import Scene
from .volume import Volume

__all__ = [
    "AreaLight",
    "Camera",
    "DirectionalLight",
    "Environment",
    "Geometry",
    "Light",
    "Material",
    "Medium",
    "Mesh",
    "PointLight",
    "PointLights",
    "Scene",
    "SpotLight",
    "Texture",
    "Volume",
]
