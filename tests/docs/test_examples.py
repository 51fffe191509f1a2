"""The examples run from any folder, headless, and leave what they promise."""

from __future__ import annotations

import runpy
from pathlib import Path

import PIL.Image
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
MADE = {
    "array_to_volume.py": ["array_to_volume.png"],
    "cloud_from_netcdf.py": ["cloud_from_netcdf.png", "cloud_with_shadow.nc"],
    "cloud_turning_sun.py": ["cloud.webp", "cloud/0000.png", "cloud/0023.png"],
    "dyed_smoke.py": ["dyed_smoke.png"],
    "error_by_samples.py": ["error_by_samples.csv"],
    "kilometre_cloud.py": [f"kilometre_cloud_{v}.png" for v in ("below", "rim", "within")],
    "many_puffs.py": ["many_puffs.png"],
    "pyvista_plume.py": ["pyvista_plume.png", "hill_with_light.vtp"],
    "smoke_in_atrium.py": ["smoke_in_atrium.png"],
    "sun_shafts.py": ["sun_shafts.png", "sun_shafts.exr", "sun_shafts_parts.png"],
    "sweep.py": ["sweep.csv", "sweep.png"],
}
NEEDS = {
    "cloud_from_netcdf.py": ["xarray", "scipy"],
    "error_by_samples.py": ["mitsuba"],
    "pyvista_plume.py": ["pyvista"],
}
OTHERS = ["read_light.mjs", "read_light.cpp"]
"""Run by `tests/exports/test_light_field_file.py`."""
NOTEBOOK = EXAMPLES / "compare_techniques.ipynb"


def test_every_example_is_run_here_and_listed():
    kinds = (".py", ".ipynb", ".mjs", ".cpp")
    there = {path.name for path in EXAMPLES.iterdir() if path.suffix in kinds}
    assert there == {*MADE, NOTEBOOK.name, *OTHERS}
    docs = (EXAMPLES.parent / "docs" / "examples.md").read_text("utf-8")
    readme = (EXAMPLES / "README.md").read_text("utf-8")
    for name in there:
        assert f"`{name}`" in docs
        assert f"({name})" in readme


def test_each_says_how_it_is_run_and_what_one_should_see():
    for name in MADE:
        text = (EXAMPLES / name).read_text("utf-8")
        assert f"    python examples/{name}" in text
        assert "You should see" in text


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.needs(*NEEDS.get(n, []))) for n in MADE]
)
def test_an_example_makes_what_it_says(gpu, small, name):
    runpy.run_path(str(EXAMPLES / name), run_name="__main__")
    for made in MADE[name]:
        path = small / made
        assert path.stat().st_size > 0, made
        if path.suffix in (".png", ".webp"):
            low, high = PIL.Image.open(path).convert("L").getextrema()
            assert high > low, f"{made} is all one colour"


@pytest.mark.slow
@pytest.mark.needs("nbformat", "nbclient", "ipykernel")
def test_the_notebook_runs_to_its_end(gpu, tmp_path):
    import nbclient as client
    import nbformat

    book = nbformat.read(NOTEBOOK, as_version=4)
    first = next(cell for cell in book.cells if "SIZE = (320, 180)" in cell.source)
    first.source = first.source.replace("(320, 180)", "(32, 18)")
    client.NotebookClient(book, timeout=300, kernel_name="python3").execute(cwd=str(tmp_path))
    outputs = [output for cell in book.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 3
    assert not [output for output in outputs if output["output_type"] == "error"]
