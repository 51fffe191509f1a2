"""NetCDF and zarr by xarray: axes, units, water, times, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io import load
from airlight.scene.io.toml_text import scene_text
from airlight.scene.io.volume_scene import FPS
from airlight.scene.io.volumes import grid_names, read_volume

pytestmark = pytest.mark.needs("xarray", "h5netcdf", "h5py", "scipy", "zarr")
VALUES = np.arange(24, dtype=np.float32).reshape(2, 3, 4)  # height, y, x


def dataset(units="kg m-3", values=VALUES, dims=("z", "y", "x"), name="ql", **coords):
    import xarray

    usual = {
        "z": ("z", [150.0, 250.0], {"units": "m", "axis": "Z"}),
        "y": ("y", [0.05, 0.15, 0.25], {"units": "km"}),
        "x": ("x", [50.0, 150.0, 250.0, 350.0], {"units": "m"}),
    }
    return xarray.Dataset(
        {name: (dims, values, {"units": units})}, coords={**usual, **coords}
    )  # fmt: skip


def written(data, path):
    if path.suffix == ".zarr":
        data.to_zarr(path, zarr_format=2)
    else:
        data.to_netcdf(path, engine="h5netcdf" if path.suffix == ".nc4" else "scipy")
    return path


@pytest.mark.parametrize("ending", [".nc", ".nc4", ".zarr"])
def test_height_is_up_and_north_is_away(tmp_path, ending):
    grid = read_volume(written(dataset(), tmp_path / f"a{ending}"))
    np.testing.assert_allclose(grid.bounds, ((0, 100, -300), (400, 300, 0)), atol=1e-3)
    assert grid.density.shape == (3, 2, 4)  # world z, y, x
    for north in range(3):
        np.testing.assert_array_equal(grid.density[2 - north], VALUES[:, north])


@pytest.mark.parametrize("dims", [("x", "y", "z"), ("y", "z", "x")])
def test_the_order_of_dimensions_does_not_matter(tmp_path, dims):
    data = dataset(values=VALUES.transpose(["zyx".index(d) for d in dims]), dims=dims)
    expected = read_volume(written(dataset(), tmp_path / "a.nc"))
    found = read_volume(written(data, tmp_path / "b.nc"))
    np.testing.assert_array_equal(found.density, expected.density)
    assert found.bounds == expected.bounds


def test_falling_coordinates_and_depth_are_turned_round(tmp_path):
    falling = dataset(values=VALUES[::-1], z=("z", [250.0, 150.0], {"units": "m"}))
    deep = dataset(values=VALUES, z=("z", [250.0, 150.0], {"units": "m", "positive": "down"}))
    np.testing.assert_array_equal(
        read_volume(written(falling, tmp_path / "a.nc")).density,
        read_volume(written(dataset(), tmp_path / "b.nc")).density,
    )
    low, high = read_volume(written(deep, tmp_path / "c.nc")).bounds
    assert (low[1], high[1]) == (-300, -100)


def test_uneven_levels_become_even_ones(tmp_path):
    heights = np.array([0.0, 100.0, 200.0, 400.0, 800.0])
    values = np.broadcast_to(heights[:, None, None], (5, 3, 4))  # linear: stays what it is
    grid = read_volume(
        written(dataset(values=values, z=("z", heights, {"units": "m"})), tmp_path / "a.nc")
    )
    assert any("'z' is not evenly spaced: 5 cells became" in text for text in grid.warnings)
    count = grid.density.shape[1]
    np.testing.assert_allclose(grid.density[0, :, 0], np.linspace(0, 800, count), atol=1e-3)


@pytest.mark.parametrize(
    ("units", "sigma_t"),
    # 3 / (2 rho r) of a kilogram of water per cubic metre in droplets of 10 micrometres.
    [("kg m-3", 150.0), ("g m-3", 0.15), ("m-1", 1.0), ("km-1", 1e-3)],
)
def test_units_say_how_dense_it_is(tmp_path, units, sigma_t):
    written(dataset(units, VALUES * 1e-3), tmp_path / "cloud.nc")
    volume = load(tmp_path / "cloud.nc").volumes[0]
    assert volume.sigma_t[0] * volume.density.max() == pytest.approx(23e-3 * sigma_t)
    assert volume.g[0] > 0.8 and volume.albedo[0] > 0.99


@pytest.mark.parametrize("units", ["degC", "Celsius", "degrees_Celsius", "K"])
def test_temperatures_are_kelvin(tmp_path, units):
    data = dataset("1", name="smoke").assign(temperature=dataset("K", 50 * VALUES)["ql"])
    data["temperature"].attrs["units"] = units
    path = written(data, tmp_path / "a.nc")
    by = 0.0 if units == "K" else 273.15
    scene = load(path)
    assert scene.volumes[0].emission.temperature.max() == pytest.approx(50 * 23 + by)
    said = [text for text in scene.warnings if "read in kelvin" in text]
    assert said == ([f"a.nc: 'temperature' is in {units}, and read in kelvin"] if by else [])


def test_mixing_ratios_are_weighed_with_the_air(tmp_path):
    volume = load(written(dataset("g kg-1"), tmp_path / "cloud.nc")).volumes[0]
    by_height = volume.density[0, :, 0] / VALUES[:, 2, 0]
    np.testing.assert_allclose(by_height, 1.2e-3 * np.exp([-150 / 8500, -250 / 8500]), rtol=1e-5)


def times(*values):
    dims = ("time", "z", "y", "x")
    return dataset(values=np.stack(values), dims=dims, time=("time", 60.0 * np.arange(len(values))))


def test_the_first_of_several_times_is_read_and_missing_values_are_none(tmp_path):
    data = times(VALUES, VALUES + 100)
    data["ql"].values[0, 0, 0, 1] = np.nan
    grid = read_volume(written(data, tmp_path / "a.nc"))
    assert grid.density.max() == 23 and grid.density[2, 0, 1] == 0
    told = 'a.nc has 2 times, the first is read (--grid "ql[-1]", in a [[volume]] grid, takes the '
    told += "last; airlight info lists them)"
    assert told in grid.warnings
    assert "a.nc: 'ql' has 1 missing values, taken as 0" in grid.warnings


def test_a_simulation_that_begins_in_clear_air_is_shown_with_its_first_cloud(tmp_path):
    clear = np.full_like(VALUES, np.nan)
    path = written(times(0 * VALUES, clear, VALUES, VALUES + 100), tmp_path / "a.nc")
    grid = read_volume(path)
    assert grid.density.max() == 23
    assert any("4 times, number 2 is read, the first that holds any" in t for t in grid.warnings)


def test_a_number_behind_the_name_chooses_the_time(tmp_path):
    path = written(times(VALUES, VALUES + 100, VALUES + 200), tmp_path / "a.nc")
    for name, most in (("ql[1]", 123), ("ql[-1]", 223), ("density[0]", 23)):
        assert read_volume(path, name).density.max() == most
    (tmp_path / "a.toml").write_text('[[volume]]\nfile = "a.nc"\ngrid = "ql[2]"\nsigma_t = 1\n')
    assert load(tmp_path / "a.toml").volumes[0].density.max() == 223
    for name in ("ql[3]", "ql[-4]"):
        with pytest.raises(SceneError, match=r"no 'ql\[.*3 times, 0 to 2"):
            read_volume(path, name)
    with pytest.raises(SceneError, match="one time"):
        read_volume(written(dataset(), tmp_path / "b.nc"), "ql[1]")


def test_a_map_by_time_is_no_grid_and_time_is_no_height(tmp_path):
    flat = dataset(values=VALUES, dims=("time", "y", "x"), time=("time", [0.0, 60.0]), name="cod")
    path = written(flat, tmp_path / "a.nc")
    assert grid_names(path) == []
    with pytest.raises(SceneError, match=r"'cod': that is time \(2 times\) x y \(3\) x x \(4\)"):
        read_volume(path)
    both = times(VALUES, VALUES)
    both["cod"] = flat["cod"]
    path = written(both, tmp_path / "b.nc")
    assert grid_names(path) == ["ql"]
    with pytest.raises(SceneError, match=r"'cod'.*Grids in space: ql"):
        read_volume(path, "cod")


def test_names_that_begin_with_a_t_are_no_times(tmp_path):
    data = dataset(dims=("theta", "y", "x"), theta=("theta", [300.0, 310.0]))
    assert read_volume(written(data, tmp_path / "a.nc")).density.shape == (3, 2, 4)


def test_the_times_of_a_file_are_a_sequence(tmp_path):
    written(times(0 * VALUES, VALUES, VALUES + 100), tmp_path / "a.nc")
    (tmp_path / "a.toml").write_text(
        '[[volume]]\nsequence = "a.nc"\nsequence_fps = 2\nsigma_t = 1\nbetween = "step"\n'
    )
    (tmp_path / "b.toml").write_text((tmp_path / "a.toml").read_text().replace("a.nc", "*.nc"))
    for scene in (load(tmp_path / "a.toml"), load(tmp_path / "b.toml")):
        assert scene.animation.last_s == 1.5
        most = [scene.at(t).volumes[0].density.max() for t in (0.0, 0.5, 1.0, 9.0)]
        assert most == [0, 23, 123, 123]
    # One number behind the name is one time.
    one = (tmp_path / "a.toml").read_text() + 'grid = "ql[2]"\n'
    (tmp_path / "c.toml").write_text(one)
    assert load(tmp_path / "c.toml").at(0.0).volumes[0].density.max() == 123


def test_other_grids_of_a_sequence_are_of_the_same_times(tmp_path):
    data = times(VALUES, VALUES + 100)
    data["hot"] = (data["ql"].dims, data["ql"].values * 2)
    data["w"] = (data["ql"].dims, np.minimum(data["ql"].values / 200, 1))
    written(data, tmp_path / "a.nc")
    (tmp_path / "a.toml").write_text(
        '[[volume]]\nsequence = "a.nc"\nsequence_fps = 1\nsigma_t = 1\ngrid = "ql"\n'
        'emission_grid = "hot"\nalbedo_grid = "w"\n'
    )
    scene = load(tmp_path / "a.toml")
    for time, most in ((0.0, 23), (1.0, 123)):
        volume = scene.at(time).volumes[0]
        assert volume.density.max() == most and volume.emission.grid.max() == 2 * most
        assert volume.albedo_grid.max() == pytest.approx(most / 200)


def test_a_bare_file_of_several_times_moves(tmp_path):
    path = written(times(0 * VALUES, VALUES, VALUES + 100), tmp_path / "a.nc")
    scene = load(path)
    shown = [scene.at(k / FPS).volumes[0].density.max() for k in range(3)]
    assert shown == [23, 123, 123] and scene.volumes[0].density.max() == 23
    assert load(path, grid="ql[2]").animation is None
    # A scene file that is written of it moves alike.
    text = scene_text(scene, scene, str(path), tmp_path, model={"grid": "ql"})
    (tmp_path / "a.toml").write_text(text)
    again = load(tmp_path / "a.toml")
    assert [again.at(k / FPS).volumes[0].density.max() for k in range(3)] == shown
    assert again.camera == scene.camera


@pytest.mark.parametrize(("units", "to_m"), [("um", 1e-6), ("m", 1.0)])
def test_water_is_as_opaque_as_the_droplets_of_the_file_make_it(tmp_path, units, to_m):
    radius = np.linspace(4e-6, 20e-6, VALUES.size).reshape(VALUES.shape)
    data = times(0 * VALUES, VALUES)
    data["re"] = (data["ql"].dims, np.stack([0 * radius, radius]) / to_m, {"units": units})
    data["re"].values[1, 1, 2, 3] = np.nan  # counts as 10 micrometres
    volume = load(written(data, tmp_path / "a.nc")).volumes[0]
    radius[1, 2, 3] = 1e-5
    expected = 3.0 * VALUES / (2.0 * 1000.0 * radius)  # m^-1, of kg m^-3
    np.testing.assert_allclose(
        volume.density[::-1] * volume.sigma_t[0], expected.transpose(1, 0, 2), rtol=1e-5
    )


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"units": "K"}, "no radius of droplets"),
        ({"name": "theta"}, ""),
        ({"of": "qi"}, ""),  # ice has radii of its own
    ],
)
def test_what_is_no_radius_of_these_droplets_is_left_alone(tmp_path, change, told):
    data = dataset(name=change.get("of", "ql"))
    name = change.get("name", "re")
    data[name] = (("z", "y", "x"), VALUES / 2, {"units": change.get("units", "um")})
    grid = read_volume(written(data, tmp_path / "a.nc"), change.get("of", "ql"))
    np.testing.assert_array_equal(grid.density[::-1], VALUES.transpose(1, 0, 2))
    said = " ".join(grid.warnings)
    assert told in said and "is the droplets" not in said


def test_degrees_become_metres_at_the_origin(tmp_path):
    data = dataset(
        y=("y", [59.9, 60.0, 60.1], {"units": "degrees_north"}),
        x=("x", [10.0, 10.1, 10.2, 10.3], {"units": "degrees_east"}),
    )
    grid = read_volume(written(data, tmp_path / "a.nc"))
    size = np.subtract(*grid.bounds[::-1])
    np.testing.assert_allclose(size[[0, 2]], [0.4 * 111195 * 0.5, 0.3 * 111195], rtol=1e-3)
    assert np.abs(np.add(*grid.bounds))[[0, 2]].max() < 1.0


def test_wrf_has_its_spacing_in_attributes(tmp_path):
    import xarray

    dims = ("Time", "bottom_top", "south_north", "west_east")
    edges = np.array([0.0, 100.0, 200.0]) * 9.81
    potential = np.broadcast_to(edges[None, :, None, None], (1, 3, 3, 4))
    staggered = ("Time", "bottom_top_stag", "south_north", "west_east")
    data = xarray.Dataset(
        {
            "QCLOUD": (dims, VALUES[None], {"units": "kg kg-1"}),
            "PH": (staggered, potential * 0.25),
            "PHB": (staggered, potential * 0.75),
        },
        attrs={"DX": 1000.0, "DY": 2000.0},
    )
    grid = read_volume(written(data, tmp_path / "a.nc"))
    np.testing.assert_allclose(grid.bounds, ((0, 0, -6000), (4000, 200, 0)), atol=0.1)


def test_wrf_levels_are_those_of_the_time_that_is_read(tmp_path):
    import xarray

    dims = ("Time", "bottom_top", "south_north", "west_east")
    staggered = ("Time", "bottom_top_stag", "south_north", "west_east")
    edges = np.array([[0.0, 100.0, 200.0], [0.0, 150.0, 300.0]]) * 9.81
    potential = np.broadcast_to(edges[:, :, None, None], (2, 3, 3, 4))
    data = xarray.Dataset(
        {
            "QCLOUD": (dims, np.stack([VALUES, VALUES]), {"units": "kg kg-1"}),
            "PH": (staggered, potential),
            "PHB": (staggered, 0 * potential),
        },
        attrs={"DX": 1000.0, "DY": 1000.0},
    )
    path = written(data, tmp_path / "a.nc")
    for number, top in ((0, 200), (1, 300)):
        assert read_volume(path, f"QCLOUD[{number}]").bounds[1][1] == pytest.approx(top)
    scene = load(path)  # whose box grows with its time
    assert scene.at(1.0 / FPS).bounds[1][1] == pytest.approx(300)


def test_a_sequence_of_zarr_folders_moves(tmp_path):
    for k in range(2):
        written(dataset(values=VALUES + 10 * k), tmp_path / f"cloud.{k}.zarr")
    text = '[[volume]]\nsequence = "cloud.*.zarr"\ngrid = "ql"\nsigma_t = 1\nsequence_fps = 1\n'
    (tmp_path / "a.toml").write_text(text)
    scene = load(tmp_path / "a.toml")
    assert scene.animation.at(scene, 1.0).volumes[0].density.max() == 33
    assert scene.animation.at(scene, 0.5).volumes[0].density.max() == 28


def test_a_sequence_may_grow(tmp_path):
    taller = np.concatenate([VALUES, VALUES + 24])
    heights = {"z": ("z", [150.0, 250.0, 350.0, 450.0], {"units": "m", "axis": "Z"})}
    written(dataset(), tmp_path / "cloud.0.nc")
    written(dataset(values=taller, **heights), tmp_path / "cloud.1.nc")
    text = '[[volume]]\nsequence = "cloud.*.nc"\ngrid = "ql"\nsigma_t = 1\nsequence_fps = 1\n'
    (tmp_path / "a.toml").write_text(text)
    scene = load(tmp_path / "a.toml")
    for k, top in enumerate((300, 500)):
        found, grid = scene.at(float(k)).volumes[0], read_volume(tmp_path / f"cloud.{k}.nc", "ql")
        np.testing.assert_allclose(found.bounds, ((0, 100, -300), (400, top, 0)), atol=1e-3)
        np.testing.assert_array_equal(found.density, grid.density)


def test_what_cannot_be_read_is_one_message(tmp_path):
    import h5py

    (tmp_path / "a.nc").write_bytes(b"no such thing")
    (tmp_path / "b.nc").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    (tmp_path / "c.nc").write_bytes(b"CDF\x01" + b"\xff" * 50)
    with h5py.File(tmp_path / "d.nc", "w") as file:
        file["ql"] = h5py.ExternalLink("/etc/hosts", "/x")
    with h5py.File(tmp_path / "e.nc", "w") as file:
        external = [("/etc/hosts", 0, 96)]
        file.create_dataset("ql", (2, 3, 4), "f4", external=external)
    (tmp_path / "f.zarr").mkdir()
    (tmp_path / "f.zarr" / "secret").symlink_to("/etc/hosts")
    (tmp_path / "i.zarr").mkdir()
    (tmp_path / "i.zarr" / "ql").symlink_to(tmp_path / "f.zarr")
    written(dataset().expand_dims(time=1).isel(time=slice(0)), tmp_path / "j.nc")
    two = dataset(name="a").assign(b=dataset()["ql"])
    written(two, tmp_path / "g.nc")
    written(dataset().isel(z=0), tmp_path / "h.nc")
    for name, message in {
        "a.nc": "is no NetCDF",
        "b.nc": "is not readable",
        "c.nc": "is not readable",
        "d.nc": "has data in other files",
        "e.nc": "has data in other files",
        "f.zarr": "outside its folder",
        "i.zarr": "a link to a folder",
        "j.nc": "no times",
        "g.nc": "has no grid 'density'. Known: a, b",
        "h.nc": "holds no grid of three dimensions",
    }.items():
        with pytest.raises(SceneError, match=name.replace(".", r"\.")) as caught:
            read_volume(tmp_path / name)
        assert message in str(caught.value), caught.value
    assert grid_names(tmp_path / "g.nc") == ["a", "b"]


def refusal(path, name="density") -> str:
    with pytest.raises(SceneError) as caught:
        load(path) if name == "density" else read_volume(path, name)
    assert str(path) in str(caught.value)
    return str(caught.value)


def test_what_is_no_grid_is_told_with_what_to_do(tmp_path):
    import xarray

    dataset().to_netcdf(tmp_path / "group.nc4", engine="h5netcdf", group="run1")
    assert "in groups (run1), which are not read" in refusal(tmp_path / "group.nc4")
    dataset().to_zarr(tmp_path / "group.zarr", group="run2", zarr_format=2)
    assert "group='run2'" in refusal(tmp_path / "group.zarr")
    (tmp_path / "empty.nc").write_bytes(b"")
    assert "is empty" in refusal(tmp_path / "empty.nc")
    flat = xarray.Dataset({"ql": (("y", "x"), VALUES[0])})
    assert "more than one along each" in refusal(written(flat, tmp_path / "flat.nc"))
    text = xarray.Dataset({"ql": (("z", "y", "x"), VALUES.astype("U2"))})
    assert "'ql' holds no numbers" in refusal(written(text, tmp_path / "text.nc4"))
    many = dataset(values=np.stack([VALUES] * 2, -1), dims=("z", "y", "x", "member"))
    assert "isel(member=0)" in refusal(written(many, tmp_path / "many.nc"))
    faint = dataset("1", VALUES * 1e-30)
    assert "too small to be seen" in refusal(written(faint, tmp_path / "faint.nc"))
    for heights, remedy in (([1.0, 1.0], "drop_duplicates('z')"), ([1.0, 1e30], "larger unit")):
        odd = dataset(z=("z", heights, {"units": "m"}))
        assert remedy in refusal(written(odd, tmp_path / "odd.nc"))
    swapped = dataset(x=("x", [1.0, 3.0, 2.0, 4.0], {"units": "m"}))
    assert "sortby('x')" in refusal(written(swapped, tmp_path / "swapped.nc"))


def test_longitudes_go_on_beyond_360_degrees(tmp_path):
    lon = ("x", [359.8, 359.9, 0.0, 0.1], {"units": "degrees_east"})
    lat = ("y", [-0.1, 0.0, 0.1], {"units": "degrees_north"})
    grid = read_volume(written(dataset(x=lon, y=lat), tmp_path / "a.nc"))
    np.testing.assert_allclose(np.subtract(*grid.bounds[::-1])[0], 0.4 * 111195, rtol=1e-3)


def test_packed_numbers_are_unpacked(tmp_path):
    data = dataset("kg m-3", VALUES * 1e-3)
    packing = {"dtype": "int16", "scale_factor": 1e-3, "add_offset": 0.01, "_FillValue": -999}
    data["ql"].encoding = packing
    data["ql"].values[0, 0, 0] = np.nan
    for ending in (".nc", ".nc4"):
        grid = read_volume(written(data, tmp_path / f"a{ending}"))
        expected = np.nan_to_num(VALUES * 1e-3).transpose(1, 0, 2)[::-1]
        np.testing.assert_allclose(grid.density, expected, atol=1e-6)


@pytest.mark.parametrize(
    ("units", "said"),
    [
        ("m", ""),
        ("km", "thin as a needle: look at the units of its axes"),
        ("mm", "or stretch it by scale = [1, 200, 1] of a [[volume]]"),
    ],
)
def test_a_grid_that_shows_next_to_nothing_is_told(tmp_path, units, said):
    data = dataset(z=("z", [150.0, 250.0], {"units": units}))
    told = " ".join(read_volume(written(data, tmp_path / "a.nc")).warnings)
    assert said in told and ("thin as a" in told) == bool(said)


def test_corners_of_cells_are_no_grid(tmp_path):
    data = dataset()
    data["lat"] = (("y", "x"), VALUES[0], {"units": "degrees_north", "bounds": "lat_bnds"})
    data["lat_bnds"] = (("y", "x", "corner"), np.zeros((3, 4, 4), np.float32))
    path = written(data, tmp_path / "a.nc")
    assert grid_names(path) == ["ql"] and load(path).volumes[0].density.max() == 23


def test_numbers_that_were_never_written_are_missing(tmp_path):
    values = VALUES.copy()
    values[1, 2, 3] = 9.9692099683868690e36
    grid = read_volume(written(dataset(values=values), tmp_path / "a.nc"))
    assert grid.density.max() == 22 and "has 1 missing values" in " ".join(grid.warnings)
    values[1, 2, 3] = 1e20
    assert "stands for no value" in refusal(written(dataset("1", values), tmp_path / "b.nc"))
