"""A cloud of a kilometre, from below, at its rim and from within.

    python examples/kilometre_cloud.py
    python examples/kilometre_cloud.py --reference [SEED]

You should see the grey base of a cumulus from the ground, the cloud's bright rim before the sky,
then the inside of the same cloud: mist, and the sun's glow through it. Cells of 55 m are too coarse
for an eye inside; `grid_levels` puts finer grids ahead of it, which take the light at their border
from the larger ones. With --reference Mitsuba renders the same, and energies and errors are
printed, of the defaults and of finer cells; SEED makes another cloud.
"""

import dataclasses
import sys

import airlight as al

SIZE, SMALL, SCALE, SPP = (480, 270), (96, 54), 20.0, 512
CAMERAS = {
    "below": al.Camera((150.0, 0.0, -120.0), (0.0, 760.0, 40.0), fov_y_deg=60.0),
    "rim": al.Camera((-420.0, 1000.0, 60.0), (320.0, 1160.0, 260.0), fov_y_deg=60.0),
    "within": al.Camera((-180.0, 1000.0, 60.0), (320.0, 1160.0, 260.0), fov_y_deg=60.0),
}
FINER = ({}, {"grid_levels": 2}, {"grid_levels": 3}, {"grid_levels": 3, "grid": 32})

# The cloud that ships, 20 times as large: 1280 m wide, up to 30 optical depths high.
has_reference = "--reference" in sys.argv[1:]
seeds = [int(word) for word in sys.argv[1:] if word.isdigit()]
small = al.scenes.cloud(seed=seeds[0] if seeds else 11)
low, high = (tuple(SCALE * x for x in corner) for corner in small.volumes[0].bounds)
cloud = dataclasses.replace(small.volumes[0], bounds=(low, high), sigma_t=(0.04,) * 3)

for name, camera in CAMERAS.items():
    camera = dataclasses.replace(camera, exposure_stops=-2.5)
    scene = dataclasses.replace(small, volumes=(cloud,), camera=camera)
    image = al.render(scene, "auto", SIZE, settings={"grid_levels": 3})
    image.save(f"kilometre_cloud_{name}.png")
    if has_reference:
        truth = al.reference.render(scene, size=SMALL, spp=SPP)
        for settings in FINER:
            ours = al.render(scene, "auto", SMALL, settings=settings)
            off = al.reference.compare(ours, truth)
            print(
                f"{name}, {settings or 'defaults'}: energy {off.energy_ratio:.2f}, "
                f"relative L2 {off.relative_l2:.2f} (noise {off.noise_floor_l2:.2f})"
            )
