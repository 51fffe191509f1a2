"""Smoke of many colours: an array of densities, and one of colours.

    python examples/dyed_smoke.py

You should see two puffs of smoke, one orange and one blue, that grow into each other over a grey
floor and mix where they meet. Colours are the albedo of each voxel (`albedo_grid`); `tint` and
`g_grid` vary extinction and phase function in the same way. Without a GPU it takes half a minute.
"""

import numpy as np

import airlight as al

CELLS = 48
axis = (np.arange(CELLS) + 0.5) / CELLS * 2 - 1
z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
waves = np.random.default_rng(3).normal(0.0, 5.0, (16, 3))
lumps = sum(np.sin(a * x + b * y + c * z + 3 * a) for a, b, c in waves) / 16


def puff(centre: float) -> np.ndarray:
    """The density (z, y, x) of a lumpy ball."""
    away = np.sqrt((x - centre) ** 2 + y * y + z * z) / 0.62
    return np.clip(5.0 - 6.0 * away + 7.0 * lumps, 0, 1)


# Two puffs; in each voxel the mean colour of what is there.
left, right = puff(-0.36), puff(0.36)
density = left + right
share = (right / np.maximum(density, 1e-6))[..., None]
colours = (1 - share) * [0.95, 0.45, 0.12] + share * [0.12, 0.45, 0.95]

corners = np.array([[-4, -1, -4], [4, -1, -4], [4, -1, 4], [-4, -1, 4]], np.float32)
floor = al.Mesh(
    al.Geometry(corners, np.array([[0, 2, 1], [0, 3, 2]], np.uint32)),
    al.Material(base_color=(0.4, 0.4, 0.4)),
)
scene = al.Scene(
    meshes=(floor,),
    volumes=(al.Volume(sigma_t=14.0, density=density, albedo_grid=colours),),
    lights=(al.DirectionalLight(direction=(-0.4, -0.8, -0.5), irradiance=(4.0, 4.0, 4.0)),),
    environment=al.Environment(radiance=(0.25, 0.28, 0.32)),
    camera=al.Camera(position=(0.0, 0.9, 4.6), target=(0.0, -0.1, 0.0), fov_y_deg=38.0),
)
al.render(scene, size=(480, 270)).save("dyed_smoke.png")
