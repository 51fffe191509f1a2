"""A cloud while the sun goes over it.

    python examples/cloud_turning_sun.py

You should see a cumulus whose lit side follows the sun: bright rims while the sun stands behind it,
a white top at noon, warm flanks in the evening. The scene stays on the device; what changes from
frame to frame is told to `frame`. The frames are kept as `cloud/0000.png` ..., and as `cloud.webp`,
which any browser plays.

The same from the command line, for whatever moves in a scene file: `airlight sequence`.
"""

import dataclasses
import math
from pathlib import Path

import PIL.Image

import airlight as al

SIZE, FRAMES, SECONDS = (480, 270), 24, 3.0
NOON = (34.0, 30.0, 25.0)  # W m^-2 on a surface that faces the sun

camera = al.Camera((6.0, 2.0, 84.0), (0.0, 46.0, 0.0), fov_y_deg=42.0, exposure_stops=-1.5)
scene = dataclasses.replace(al.scenes.cloud(), camera=camera)
assert scene.environment is not None
folder = Path("cloud")
folder.mkdir(exist_ok=True)

with al.Renderer(scene, technique="pop", size=SIZE) as renderer:
    for index in range(FRAMES):
        # Over the sky from the left, behind the cloud, to the right.
        height = math.radians(12.0 + 156.0 * index / (FRAMES - 1))
        travel = (math.cos(height), -math.sin(height), 0.45)
        warmth = 1.0 - math.sin(height)  # a low sun has lost its blue
        colour = tuple(c * (1.0 - warmth * k) for c, k in zip(NOON, (0.1, 0.45, 0.75), strict=True))
        image = renderer.frame(
            lights=[al.DirectionalLight(travel, colour)],
            environment=dataclasses.replace(scene.environment, scale=1.0 - 0.7 * warmth),
            samples=4,
        )
        image.save(folder / f"{index:04}.png")
        print(f"frame {index + 1} of {FRAMES}", flush=True)

frames = [PIL.Image.open(path) for path in sorted(folder.glob("*.png"))]
frames[0].save(
    "cloud.webp",
    save_all=True,
    append_images=frames[1:],
    loop=0,
    duration=round(1000 * SECONDS / FRAMES),
    quality=85,
)
print(Path("cloud.webp").resolve())
