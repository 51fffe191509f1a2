"""A foggy room with the sun in its window, and the parts that its light is made of.

    python examples/sun_shafts.py

You should see shafts of sunlight slanting from the window across a furnished room, their edges
sharp where the frame stands, and the whole room glowing faintly from light scattered many times. In
`sun_shafts_parts.png` the same image is taken apart: light that met one surface, light that
bounced, light scattered once in the air (the shafts), light scattered more often (the glow).
"""

from pathlib import Path

import numpy as np
import PIL.Image

import airlight as al

SIZE = (640, 360)
PARTS = ("direct", "indirect", "single_scatter", "multiple_scatter")

scene = al.scenes.foggy_room()
image = al.render(scene, technique="lpv-scatter", size=SIZE)
image.save("sun_shafts.png")
image.save("sun_shafts.exr")  # with every layer, for compositing

shown = [image.display(name) for name in PARTS]
sheet = np.vstack([np.hstack(shown[:2]), np.hstack(shown[2:])])
PIL.Image.fromarray(sheet).save("sun_shafts_parts.png")
for name in PARTS:
    share = image.layers[name].sum() / image.radiance.sum()
    print(f"{name:>16}: {share:6.1%} of the light")
print(Path("sun_shafts.png").resolve())
