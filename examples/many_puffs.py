"""Forty puffs of smoke over a floor: one array, placed forty times.

    python examples/many_puffs.py

You should see a drift of small lumpy clouds over a grey floor, lit by the sun from one side, with
their shadows on the floor and on each other. A scene holds up to 256 volumes; they may overlap, and
each is placed by a matrix of its own. Volumes of one array share its memory on the device. Without
a GPU it takes a minute or two.
"""

import numpy as np

import airlight as al

COUNT, CELLS = 40, 24
random = np.random.default_rng(5)

# One lumpy ball: a density (z, y, x) that some smooth noise eats into.
axis = (np.arange(CELLS) + 0.5) / CELLS * 2 - 1
z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
waves = random.normal(0.0, 4.0, (12, 3))
lumps = sum(np.sin(a * x + b * y + c * z + 3 * a) for a, b, c in waves) / 12
density = np.clip(2.0 - 2.5 * np.sqrt(x * x + y * y + z * z) + 1.5 * lumps, 0, 1)


def placed() -> np.ndarray:
    """4x4: somewhere above the floor, turned about the vertical, stretched."""
    angle = random.uniform(0, 2 * np.pi)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    matrix = np.eye(4)
    matrix[:3, :3] = turn * random.uniform(0.3, 0.6, 3)
    matrix[:3, 3] = random.uniform((-3, 0.7, -3), (3, 1.8, 3))
    return matrix


puffs = tuple(
    al.Volume(sigma_t=8.0, albedo=0.95, g=0.3, density=density, world_from_volume=placed())
    for _ in range(COUNT)
)
corners = np.array([[-4, 0, -4], [4, 0, -4], [4, 0, 4], [-4, 0, 4]], np.float32)
floor = al.Mesh(
    al.Geometry(corners, np.array([[0, 2, 1], [0, 3, 2]], np.uint32)),
    al.Material(base_color=(0.15, 0.14, 0.12)),
)
scene = al.Scene(
    meshes=(floor,),
    volumes=puffs,
    lights=(al.DirectionalLight(direction=(0.6, -0.7, -0.4), irradiance=(6.0, 5.4, 4.5)),),
    environment=al.Environment(radiance=(0.12, 0.19, 0.32)),
    camera=al.Camera(position=(0.0, 3.2, 8.5), target=(0.0, 0.8, 0.0), fov_y_deg=42.0),
)
al.render(scene, size=(480, 270)).save("many_puffs.png")
