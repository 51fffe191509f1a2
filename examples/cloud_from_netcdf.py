"""A cloud of a simulation in NetCDF, by xarray, and its shadow as a new variable of the file.

    python examples/cloud_from_netcdf.py

You should see a small cumulus in the afternoon (cloud_from_netcdf.png), and in the file
cloud_with_shadow.nc, beside the water, how much sunlight comes through each column. Bring your own
file instead: heights, distances and units come from its coordinates. Needs the extra:
pip install "airlight[science]".
"""

import numpy as np
import xarray as xr

import airlight as al


def made_cloud(path: str) -> None:
    """A file as a cloud model writes it: liquid water, g kg-1, over height, y and x."""
    z, y, x = (np.arange(n) * step + 0.5 * step for n, step in ((30, 40.0), (48, 50.0), (48, 50.0)))
    height, north, east = np.meshgrid(z, y, x, indexing="ij")
    water = np.zeros(height.shape)
    for middle, radius in (((1100, 1200), 420), ((1450, 1150), 300), ((1250, 1500), 320)):
        # Flat below, where the air becomes moist enough, and round above.
        r = np.hypot(east - middle[0], north - middle[1])
        top = 500 + 1.3 * np.sqrt(np.maximum(radius**2 - r**2, 0))
        inside = (height > 500) & (height < top) & (r < radius)
        water = np.maximum(water, np.where(inside, 0.3 + 0.0008 * (height - 500), 0))
    xr.Dataset(
        {"ql": (("z", "y", "x"), water.astype(np.float32), {"units": "g kg-1"})},
        coords={
            "z": ("z", z, {"units": "m", "axis": "Z"}),
            "y": ("y", y, {"units": "m", "axis": "Y"}),
            "x": ("x", x, {"units": "m", "axis": "X"}),
        },
    ).to_netcdf(path, engine="scipy")


made_cloud("cloud.nc")

# ---- From here on it is airlight -----------------------------------------------------------------
scene = al.load("cloud.nc", sun="35,240")  # height and azimuth of the sun, degrees
for text in scene.warnings:
    print(text)
al.render(scene, size=(480, 360)).save("cloud_from_netcdf.png")

# The grid as airlight has it goes back into xarray: here z is the file's -y, y its height.
volume = scene.volumes[0]
depth = volume.density.sum(axis=1) * volume.sigma_t[0]  # per metre, summed over heights
depth *= (volume.bounds[1][1] - volume.bounds[0][1]) / volume.density.shape[1]
cloud = xr.load_dataset("cloud.nc", engine="scipy")
cloud["sunlight"] = (("y", "x"), np.exp(-depth[::-1]))
cloud["sunlight"].attrs = {"long_name": "share of vertical sunlight unscattered", "units": "1"}
cloud.to_netcdf("cloud_with_shadow.nc", engine="scipy")
