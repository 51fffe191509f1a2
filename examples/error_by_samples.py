"""How far stills of more and more samples are from a path tracer, as a table.

    python examples/error_by_samples.py

You should see the error of the indirect light fall from one sample to sixteen. The rest lies in the
technique, not in its noise; the last line is the path tracer's own noise, below which no error can
be told. `error_by_samples.csv` has the columns to plot. Any scene that airlight reads
can stand in SCENE, such as Mitsuba's cbox.xml. Needs the extra: pip install "airlight[reference]".
"""

import csv
from pathlib import Path

import airlight as al

SCENE = "builtin:cornell"
SIZE = (96, 54)
SAMPLES = (1, 4, 16)
PATHS = 1024  # of the path tracer, for a pixel

scene = al.load(SCENE)
stills = {samples: al.render(scene, size=SIZE, samples=samples) for samples in SAMPLES}
height, width = stills[SAMPLES[0]].radiance.shape[:2]
truth = al.reference.render(scene, size=(width, height), spp=PATHS, layers=("all", "indirect"))

rows = []
for samples, image in stills.items():
    score = al.reference.compare(image, truth, perceptual=False)
    rows.append((samples, score.relative_l2, score.layers["indirect"].relative_l2))
    print("{:3d} samples: whole image {:.4f}, indirect light {:.4f}".format(*rows[-1]))
print(f"the path tracer's noise: {score.noise_floor_l2:.4f}")

with Path("error_by_samples.csv").open("w", newline="") as file:
    table = csv.writer(file)
    table.writerow(["samples", "relative_l2", "relative_l2_indirect"])
    table.writerows(rows)
