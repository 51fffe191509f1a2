"""A cloud of a kilometre, from below and from within.

    python examples/kilometre_cloud.py
    python examples/kilometre_cloud.py --reference

You should see the grey base of a cumulus from the ground, then the inside of the same cloud: bright
mist, the sun's glow through it, blue sky at the rim. Cells of 40 m are too coarse for an eye
inside; `grid_levels` puts finer grids ahead of it, which take the light at their border from the
larger ones. With --reference Mitsuba renders the same, and the energies are compared.
"""

import dataclasses
import sys

import airlight as al

SIZE, SCALE = (480, 270), 20.0
CAMERAS = {
    "below": al.Camera((150.0, 0.0, -120.0), (0.0, 760.0, 40.0), fov_y_deg=60.0),
    "within": al.Camera((-180.0, 1000.0, 60.0), (320.0, 1160.0, 260.0), fov_y_deg=60.0),
}

# The cloud that ships, 20 times as large: 1280 m wide, up to 30 optical depths high.
small = al.scenes.cloud(seed=11)
low, high = (tuple(SCALE * x for x in corner) for corner in small.volumes[0].bounds)
cloud = dataclasses.replace(small.volumes[0], bounds=(low, high), sigma_t=(0.04,) * 3)

for name, camera in CAMERAS.items():
    camera = dataclasses.replace(camera, exposure_stops=-2.5)
    scene = dataclasses.replace(small, volumes=(cloud,), camera=camera)
    image = al.render(scene, "pop", SIZE, settings={"grid_levels": 3})
    image.save(f"kilometre_cloud_{name}.png")
    if "--reference" in sys.argv[1:]:
        truth = al.reference.render(scene, size=(96, 54), spp=256)
        for levels in (1, 2, 3):
            settings = {"grid_levels": levels}
            ours = al.render(scene, "pop", (96, 54), settings=settings)
            found = al.reference.compare(ours, truth)
            ratio = ours.radiance.mean() / truth.radiance.mean()
            print(f"{name}, {levels} grids: energy {ratio:.2f}, FLIP {found.flip:.3f}")
