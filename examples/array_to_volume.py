"""A NumPy array from a simulation, straight into an image: the last five lines.

    python examples/array_to_volume.py

You should see a puff of smoke that has risen and curled in on itself: two hundred steps of a small
simulation of hot air, here so that the example has something to show. Bring your own array instead:
(z, y, x), any float type, 0 where the air is clear.
"""

import numpy as np


def rising_puff(cells: int = 48, steps: int = 200) -> np.ndarray:
    """Density (z, y, x) of a puff carried along by a vortex ring, which it is drawn into."""
    axis = (np.arange(cells) + 0.5) / cells * 2 - 1
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    around = np.hypot(x, z)
    angle = np.arctan2(z, x)
    wobble = 0.04 * np.sin(5 * angle) + 0.03 * np.sin(8 * angle + 1)
    # A vortex ring of radius .45 around the axis: up inside it, down outside.
    to_core = np.hypot(around - 0.45 - wobble, y - 0.1)
    spin = np.exp(-((to_core / 0.3) ** 2)) * 1.2
    up, outward = -spin * (around - 0.45), spin * (y - 0.1)
    velocity = np.stack([outward * z / (around + 1e-6), up, outward * x / (around + 1e-6)])
    # Follow the flow backwards: where each cell's smoke came from.
    place = np.stack([z, y, x])
    for _ in range(steps):
        index = np.clip(((place + 1) / 2 * cells).astype(int), 0, cells - 1)
        place = place - 0.05 * velocity[:, index[0], index[1], index[2]]
    start = np.hypot(np.hypot(place[0], place[2]) / 0.75, (place[1] + 0.3) / 0.28)
    return np.clip(1.5 - 1.5 * start, 0, 1)


density = rising_puff()

# ---- From here on it is airlight -----------------------------------------------------------------
import airlight as al  # noqa: E402

smoke = al.Volume(sigma_t=12.0, albedo=(0.9, 0.93, 0.96), density=density)  # fills -1 to 1 m
scene = al.with_defaults(al.Scene(volumes=(smoke,)))  # a camera, a sun and a sky
al.render(scene, size=(480, 360)).save("array_to_volume.png")
