"""Smoke in an atrium: the smoke of one scene, set into another.

    python examples/smoke_in_atrium.py

You should see a plume rise in the court of the atrium, white where the sun meets it, and its shadow
on the paving. The plume is solved by principal ordinates, the light between the walls by light
propagation volumes, both in one frame: that is what the technique `auto` does.
"""

import dataclasses
from pathlib import Path

import airlight as al

SIZE = (640, 360)

atrium = al.scenes.atrium()
(plume,) = al.scenes.smoke().volumes

# A volume fills a box of the world; a larger box makes a larger plume, and a thinner one per metre.
foot, height, width = (-1.0, 0.1, 1.6), 6.0, 3.0
low = (foot[0] - width / 2, foot[1], foot[2] - width / 2)
high = (foot[0] + width / 2, foot[1] + height, foot[2] + width / 2)
plume = dataclasses.replace(plume, bounds=(low, high), sigma_t=(16.0, 16.0, 16.0))

scene = dataclasses.replace(atrium, volumes=(plume,))
image = al.render(scene, size=SIZE)
image.save("smoke_in_atrium.png")
print("solved by", image.stats.get("chosen"), "on", image.stats["device"])
print(Path("smoke_in_atrium.png").resolve())
