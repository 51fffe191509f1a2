"""What pages take from the code is what the code says now; every technique has its page."""

from __future__ import annotations

import dataclasses
import difflib
import inspect
import pkgutil
import re
from pathlib import Path

import pytest

import airlight
from airlight.app import cli
from airlight.maths import lattice6, lattice26
from airlight.techniques import TECHNIQUES, technique_settings
from scripts import script

DOCS = Path(__file__).parents[2] / "docs"
SECTIONS = ("## Idea", "## Settings", "## How far off", "## Limits", "## When to use it")


@pytest.fixture(scope="module")
def generate():
    return script(DOCS / "generate.py")


def test_generated_parts_are_up_to_date(generate):
    for path, text in generate.generated_pages().items():
        kept = path.read_text(encoding="utf-8") if path.exists() else ""
        changes = difflib.unified_diff(kept.splitlines(), text.splitlines(), lineterm="", n=0)
        assert kept == text, f"./run docs writes {path.name} again:\n" + "\n".join(changes)


def test_the_python_reference_tells_nothing_of_the_inside(generate):
    page = generate.python_page()
    told = set(re.findall(r"[\w.]+", page))
    for package in (airlight.reference, airlight.scenes):
        hidden = {m.name for m in pkgutil.iter_modules(package.__path__)} - set(package.__all__)
        assert not {name for name in hidden if "_" in name} & told
    assert not re.findall(r"airlight\.\w+\.\w+|\w+\.(?:wgsl|py)\b", page)
    # What is handed on is described where it is called.
    assert "spp: int = 256" in page and "(name: str, **options: Any)" in page


@pytest.mark.parametrize("name", list(TECHNIQUES))
def test_a_technique_has_a_page_with_all_that_one_asks(name):
    text = (DOCS / "techniques" / f"{name}.md").read_text(encoding="utf-8")
    assert text.startswith(f"# {name}\n")
    places = [text.index(section) for section in SECTIONS]
    assert places == sorted(places)
    assert f"<!-- generated: settings {name} -->" in text
    assert f"<!-- generated: errors {name} -->" in text


@pytest.mark.parametrize("name", list(TECHNIQUES))
def test_every_setting_says_what_it_means(name):
    for field in dataclasses.fields(technique_settings(name)):
        assert field.metadata.get("help"), field.name


def test_a_settings_table_leaves_out_what_is_shared(generate):
    table = generate.settings_table("lpv")
    assert "| `iterations` |" in table
    assert "| `shadow_resolution` |" not in table
    assert "index.md#settings-of-surfaces" in table
    assert "| `shadow_resolution` | 2048 | px | 16 to 8192 |" in generate.settings_table("surfaces")


def test_errors_are_those_of_the_accuracy_page(generate):
    table = generate.errors_table("direct").splitlines()
    assert table[0].startswith("| scene | direct |")
    whole = (DOCS / "accuracy.md").read_text(encoding="utf-8")
    scenes = re.findall(r"^\| ([\w-]+) \| direct \|", whole, re.MULTILINE)
    assert [row.split(" | ")[0].strip("| ") for row in table[2:]] == scenes
    summary = generate.summary_table()
    assert all(f"| {scene} |" in summary for scene in scenes)
    assert generate.errors_table("nothing") == "Not in [accuracy](../accuracy.md) yet."


def test_numbers_that_a_page_quotes_are_the_code_s():
    lpv = (DOCS / "techniques" / "lpv.md").read_text(encoding="utf-8")
    assert f"\\lambda = {lattice6.LOOKUP_SCALE}$$" in lpv
    assert f"\\kappa = {lattice6.SPREAD_KEPT}$" in lpv
    face = lattice6.face_seen((0, 0, 1), (0, 0, 1))
    assert f"$\\Omega = {face.solid_angle_sr:.6f}$" in lpv
    assert f"(0, 0, {face.receive[2]:.6f})" in lpv
    scatter = (DOCS / "techniques" / "lpv-scatter.md").read_text(encoding="utf-8")
    assert f"\\rho = {lattice26.RHO}$$" in scatter
    for weight in {f"{w:.6f}" for w in lattice26.hops().weights}:
        assert f"${weight}$" in scatter or f"= {weight}$" in scatter


COMMON = {
    "unknown technique 'lpw'. Did you mean 'lpv'?": [
        "render",
        "builtin:cornell",
        "-o",
        "a.png",
        "-t",
        "lpw",
    ],
    "technique lpv: unknown setting 'resolutoin'. Did you mean 'resolution'?": [
        "render",
        "builtin:cornell",
        "-o",
        "a.png",
        "-t",
        "lpv",
        "-D",
        "resolutoin=8",
    ],
    "setting resolution = '1000' is out of range. It goes from 4 to 256.": [
        "render",
        "builtin:cornell",
        "-o",
        "a.png",
        "-t",
        "lpv",
        "-D",
        "resolution=1000",
    ],
    "a scene file cannot end in '.fbx'": ["render", "a.fbx", "-o", "a.png"],
    "room.obj: file not found. Check the path.": ["render", "room.obj", "-o", "a.png"],
    "--layers needs an .exr, .png holds one image": [
        "render",
        "builtin:cornell",
        "-o",
        "a.png",
        "--layers",
    ],
    "nothing moves in 'room'": ["sequence", "builtin:room", "-o", "frames"],
}


@pytest.mark.parametrize("message", COMMON)
def test_messages_of_the_troubleshooting_page_are_what_is_said(
    message, capsys, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)
    assert f"`{message}`" in (DOCS / "troubleshooting.md").read_text(encoding="utf-8")
    assert cli.run(COMMON[message]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.needs("sphinx", "furo")
def test_the_site_is_built_without_a_warning(tmp_path):
    from sphinx.cmd import build

    code = build.main(["-q", "-W", "--keep-going", "-b", "html", str(DOCS), str(tmp_path / "site")])
    assert code == 0
    page = (tmp_path / "site" / "techniques" / "lpv.html").read_text("utf-8")
    assert "<math" in page
    assert "https://cdn" not in page


@pytest.mark.parametrize(
    "said",
    [
        "has no memory left for",
        "MiB of memory are left for the graphics driver",
        "the device was lost: ",
        "this process was forked from one that had used the graphics driver, ",
        "and a fork has none of its threads",
        "is used by two threads at once",
        "this Renderer",
        "is closed",
        "Make a new one",
    ],
)
def test_what_the_troubleshooting_page_says_of_devices_is_said(said):
    page = " ".join((DOCS / "troubleshooting.md").read_text(encoding="utf-8").split())
    source = Path(airlight.__file__).parent
    files = [*(source / "gpu").glob("*.py"), source / "rendering.py"]
    code = "".join(path.read_text(encoding="utf-8") for path in files)
    # Messages are put together there: `has no memory left{what}`.
    assert said.strip() in page
    assert said.removesuffix(" for") in code


def public_callables():
    """(name, function or class) of all that the Python reference prints with a signature."""
    for name in airlight.__all__:
        value = getattr(airlight, name)
        if inspect.ismodule(value):
            own = ((key, getattr(value, key)) for key in value.__all__)
            yield from ((f"{name}.{key}", f) for key, f in own if inspect.isfunction(f))
        elif inspect.isfunction(value):
            yield name, value
        elif inspect.isclass(value) and not issubclass(value, Exception):
            yield name, value
            asked_for = {key for base in value.__mro__[1:-1] for key in vars(base)}
            for key, member in vars(value).items():
                function = getattr(member, "__func__", member)
                if (
                    not key.startswith("_")
                    and key not in asked_for
                    and inspect.isfunction(function)
                ):
                    yield f"{name}.{key}", function


def test_every_public_parameter_is_described(generate):
    """In its docstring, by the keys of scene files, or among those that mean the same anywhere."""
    silent = [
        f"{name}({parameter})"
        for name, value in public_callables()
        for parameter in inspect.signature(value).parameters
        if parameter not in generate.described(value)
    ]
    assert not silent, "\n".join(silent)


def test_parameters_of_lights_are_those_of_scene_files_with_units(generate):
    page = generate.python_page()
    assert "- `radiance`: colour, W m^-2 sr^-1: radiance" in page
    assert "- `inner_deg`: number, degrees: half angle lit in full" in page
    for name in ("LatticeLight", "VolumeLight", "Progress", "Vec3", "Rgb"):
        assert f"### {name}\n" in page or f"| `{name}` |" in page
