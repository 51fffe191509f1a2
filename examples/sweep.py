"""A parameter sweep: what the lattice's resolution costs and brings, as a table and an image.

    python examples/sweep.py

You should see the same corner four times: with 8 cells along the longest side the coloured light of
the walls is a blur that leaks into the boxes' shadows, from 24 on little changes. `sweep.csv` says
how far each is from the finest, and how long a frame took (first frame left out).
"""

import csv
from pathlib import Path

import numpy as np
import PIL.Image

import airlight as al

SIZE = (320, 180)
RESOLUTIONS = (8, 16, 24, 40)
FRAMES = 4

scene = al.scenes.cornell()
images, frame_ms = {}, {}
for resolution in RESOLUTIONS:
    settings = {"resolution": resolution}
    with al.Renderer(scene, technique="lpv", size=SIZE, settings=settings) as renderer:
        for _ in range(FRAMES):
            image = renderer.frame(samples=2)
        images[resolution], frame_ms[resolution] = image, renderer.stats()["frame_ms"]

finest = images[RESOLUTIONS[-1]].layers["indirect"]
with Path("sweep.csv").open("w", newline="") as file:
    rows = csv.writer(file)
    rows.writerow(["resolution", "relative_l2_to_finest", "energy", "frame_ms"])
    for resolution, image in images.items():
        bounced = image.layers["indirect"]
        error = np.sqrt(((bounced - finest) ** 2).sum() / (finest**2).sum())
        energy = bounced.sum() / finest.sum()
        rows.writerow([resolution, f"{error:.4f}", f"{energy:.4f}", f"{frame_ms[resolution]:.1f}"])
print(Path("sweep.csv").read_text())

shown = [image.display() for image in images.values()]
sheet = np.vstack([np.hstack(shown[:2]), np.hstack(shown[2:])])
PIL.Image.fromarray(sheet).save("sweep.png")
