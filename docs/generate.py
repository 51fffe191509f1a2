"""Write what these pages take from the code: settings, commands, names, measured errors.

    python docs/generate.py

Whole pages: scene-file.md, command-line.md, python.md. In other pages, what stands between
`<!-- generated: KIND NAME -->` and `<!-- generated: end -->`.
"""

from __future__ import annotations

import dataclasses
import inspect
import pkgutil
import re
import types
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import click

import airlight
from airlight import env
from airlight.app.cli import airlight as command_line
from airlight.app.scenes import descriptions
from airlight.exports.light_field import LatticeLight, VolumeLight
from airlight.figures.registry import FIGURES
from airlight.gather.settings import GatherSettings
from airlight.gpu.lifetime import DeviceLifetime
from airlight.lighting.kit import SurfaceSettings
from airlight.media.settings import MediaSettings
from airlight.reference.metrics import Metrics
from airlight.reference.mitsuba import render as render_reference
from airlight.scene.io.toml_page import schema_markdown
from airlight.scene.lights.light_key import LightKey
from airlight.scene.lights.light_type import LightType
from airlight.techniques import TECHNIQUES, technique_settings

DOCS = Path(__file__).parent
_PART = re.compile(
    r"(<!-- generated: (?P<kind>[\w-]+)(?: (?P<name>[\w-]+))? -->\n)(?P<body>.*?)"
    r"(<!-- generated: end -->)",
    re.DOTALL,
)
_SHARED = {"surfaces": SurfaceSettings, "gathering": GatherSettings, "air": MediaSettings}


def generated_pages() -> dict[Path, str]:
    """Every page that the code has a part in, as it should be."""
    pages = {
        DOCS / "scene-file.md": schema_markdown(),
        DOCS / "command-line.md": command_line_page(),
        DOCS / "python.md": python_page(),
    }
    for path in (DOCS.parent / "README.md", *sorted(DOCS.rglob("*.md"))):
        if path not in pages:
            text = path.read_text(encoding="utf-8")
            if _PART.search(text):
                pages[path] = _PART.sub(_filled, text)
    return pages


def _filled(part: re.Match[str]) -> str:
    kinds: dict[str, Callable[[str], str]] = {
        "settings": settings_table,
        "errors": errors_table,
        "switches": lambda _: switches_table(),
        "scenes": lambda _: scenes_table(),
        "figures": lambda _: figures_table(),
        "summary": lambda _: summary_table(),
    }
    return f"{part[1]}{kinds[part['kind']](part['name'] or '')}\n{part[5]}"


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    names = list(head)
    lines = [names, ["---"] * len(names), *map(list, rows)]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


# ---- Settings ----------------------------------------------------------------------------------


def settings_table(name: str) -> str:
    """Settings of a technique that are its own, or of a shared class (surfaces, gathering, air)."""
    if name in _SHARED:
        return _settings_rows(dataclasses.fields(_SHARED[name]))
    cls = technique_settings(name)
    shared = {
        field.name: field.default for base in _SHARED.values() for field in dataclasses.fields(base)
    }
    own = [
        field
        for field in dataclasses.fields(cls)
        if field.name not in shared or field.default != shared[field.name]
    ]
    beside = [
        f"[{key}](index.md#settings-of-{key})"
        for key, base in _SHARED.items()
        if {f.name for f in dataclasses.fields(base)} <= {f.name for f in dataclasses.fields(cls)}
    ]
    also = f"And those of {' and '.join(beside)}, which several techniques share."
    return f"{_settings_rows(own)}\n\n{also}" if own else also


def _settings_rows(fields: Iterable[dataclasses.Field[Any]]) -> str:
    return _table(
        ("setting", "default", "unit", "range", "meaning"),
        (
            (f"`{f.name}`", _value(f.default), f.metadata["unit"], _range(f), f.metadata["help"])
            for f in fields
        ),
    )


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return "none" if value == () else f"{value}"


def _range(field: dataclasses.Field[Any]) -> str:
    low, high, choices = (field.metadata[key] for key in ("low", "high", "choices"))
    if choices:
        return ", ".join(f"`{choice}`" for choice in choices)
    if isinstance(field.default, bool):
        return "true, false"
    return "" if low is None else f"{low} to {high if high is not None else 'any'}"


# ---- Numbers -----------------------------------------------------------------------------------


def errors_table(technique: str) -> str:
    """The technique's rows of accuracy.md."""
    names, measured = _accuracy()
    rows = [cells for cells in measured if cells[1] == technique]
    if not rows:
        return "Not in [accuracy](../accuracy.md) yet."
    keep = [k for k in range(len(names)) if k != 1 and any(row[k] for row in rows)]
    title = (names[k].replace("_", " ") for k in keep)
    return _table(title, ([row[k] for k in keep] for row in rows))


_LAYERS = {
    "direct": "direct light",
    "one_bounce": "one bounce",
    "indirect": "all bounces",
    "single_scatter": "scattered once",
    "multiple_scatter": "scattered more often",
    "whole": "whole image",
    "FLIP": "FLIP",
}


def summary_table() -> str:
    """Of accuracy.md: each layer's errors in each scene, by the technique that `auto` takes."""
    names, measured = _accuracy()
    by_auto = {cells[0]: cells for cells in measured if cells[1] == "lpv"}
    by_auto |= {cells[0]: cells for cells in measured if cells[1] == "auto"}
    columns = [names.index(layer) for layer in _LAYERS]
    return _table(
        ("scene", *_LAYERS.values()),
        ((scene, *(cells[k] or "-" for k in columns)) for scene, cells in by_auto.items()),
    )


def _accuracy() -> tuple[list[str], list[list[str]]]:
    """Column names and rows of the table of scenes."""
    lines = (DOCS / "accuracy.md").read_text(encoding="utf-8").splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    first = next(k for k, row in enumerate(cells) if row[:2] == ["scene", "technique"])
    end = next(k for k in range(first, len(lines)) if not lines[k].startswith("|"))
    return cells[first], cells[first + 2 : end]


def switches_table() -> str:
    """The AIRLIGHT_* variables."""
    rows = ((f"`{s.name}`", f"`{s.default}`" if s.default else "", s.meaning) for s in env.SWITCHES)
    return _table(("variable", "default", "meaning"), rows)


def scenes_table() -> str:
    """The scenes that ship."""
    return _table(("scene", "shows"), ((f"`{k}`", v) for k, v in descriptions().items()))


def figures_table() -> str:
    """The figures of the papers."""
    rows = ((f"`{name}`", f.source, f.shows) for name, f in FIGURES.items())
    return _table(("figure", "beside", "shows"), rows)


# ---- The command line --------------------------------------------------------------------------


PROMISES = """\
| exit code | means |
|---|---|
| 0 | done |
| 2 | bad input, a missing capability or an output that cannot be written, in one message |
| 1 | a mistake of ours |
| 130 | interrupted by Ctrl-C, at any moment |
| 141 | whoever read the output closed its pipe (`airlight scenes \\| head -1`); nothing is said |

## What is written, and what is not

- No output replaces an input. A command refuses to write over any file that it reads: the scene,
  what it includes, meshes, materials, textures, grids and sequences of them, environments. Files
  are known by what they are, not by their names: links, `..` and the case of letters make no
  difference. Two outputs of one command cannot be one file.
- A file is written beside its place under a hidden name, and renamed when it is whole. A command
  that fails, is killed or fills the disk leaves the file that was there. The new file has the
  permissions of the one that it replaces; a symbolic link stays one, and its file is replaced.
  Write-protected files stay.
- Outputs are regular files, `/dev/null`, `/dev/stdout`, `/dev/stderr` or `/dev/fd/N` (a shell's
  `>(...)`). Pipes with a name, sockets and disks are refused.
- `convert` to Mitsuba XML replaces the folder `NAME_files` beside it only if nothing but such files
  is in it.
"""


def command_line_page() -> str:
    """Every command with its help, as it prints it."""
    parts = [
        "# Command line\n",
        "Printed from the commands' own `--help` by `./run docs`. Results go to standard output, "
        "progress, warnings and errors to standard error.\n",
        PROMISES,
    ]
    context = click.Context(
        command_line, info_name="airlight", terminal_width=88, **command_line.context_settings
    )
    for name in command_line.list_commands(context):
        command = command_line.get_command(context, name)
        assert command is not None
        own = click.Context(command, info_name=name, parent=context, terminal_width=88)
        parts.append(f"## airlight {name}\n\n```text\n{command.get_help(own)}\n```\n")
    return "\n".join(parts)


# ---- Python ------------------------------------------------------------------------------------


COMMON = {
    "technique": "a technique's name, as `airlight render -t` takes it: `auto`, `lpv`, ...",
    "settings": "a mapping of the technique's settings by name, as `airlight render -D` takes them",
    "adapter": "`auto`, `cpu`, `gpu` or a part of the graphics adapter's name",
    "size": "(width, height) of the image, pixels",
    "samples": "how many jittered images are averaged",
    "progress": "is called as `progress(stage, share)` after each step; a `Progress`",
    "path": "of a file: text, or a `pathlib.Path`",
    "seed": "a whole number: another one is another scene of the same kind",
    "g": "mean cosine of the phase function, -1 to 1: above 0 light goes on forwards",
}
"""Parameters that mean the same everywhere; a docstring that names one says more of it."""

TYPES = {
    "`Vec3`": "three numbers (x, y, z): a point in metres, or a direction, of any length but 0",
    "`Rgb`": "three numbers (red, green, blue), linear Rec.709",
    "`Bounds`": "two `Vec3`: the lowest and the highest corner of a box along the axes, metres",
    "`F32`, `F64`": "a NumPy array of float32 or float64",
    "`Progress`": "`Callable[[str, float], None]`: takes a stage's name and the share done, 0 to 1",
    "`AreaShape`": '`"rectangle"`, `"disk"` or `"sphere"`',
}
"""What signatures call by a name of airlight's own."""


_PROMISES = """\
## Threads, processes, lost devices

**Threads.** Each thread may have renderers of its own, as many as there is memory for; they share
one device and its compiled shaders, and their images are bit for bit those of one thread alone.
One renderer serves one thread at a time: a second one that asks while the first is served gets
`DeviceError` at once. It may be made in one thread and go on in another. Scenes never change and
may be shared.

**Processes.** A process forked from one that has used the device has none of the driver's
threads, and would wait for ever: whatever it asks of the device raises `DeviceError`. Use
`multiprocessing.get_context("spawn")`; forking is Python's own default on Linux before 3.14. A
parent that only imported airlight may be forked.

**Lost devices and memory.** A device that was lost, and memory that ran out, of the device or of
the machine, are `DeviceError` (exit code 2 on the command line). A new `Renderer`, or the next
`frame` of the old one, opens the device again. Some failures of drivers end the process by
themselves, and no message can be made of those; sizes are checked against the device's limits
before it is asked.

**What breaks off.** A `frame` or `resize` that an error or Ctrl-C breaks off never was: the next
one recreates what it needs and gives the same bits. A renderer that cannot be made keeps no
memory. After `close` a renderer raises `DeviceError`; to close it again does nothing.
"""


def python_page() -> str:
    """Every public name with its signature and its docstring."""
    parts = [
        "# Python reference\n",
        "Printed from the docstrings by `./run docs`. `import airlight as al`; everything here is "
        "`al.NAME`. Arrays are NumPy's; lengths are metres, colours linear Rec.709.\n",
    ]
    parts.append(_PROMISES)
    groups = _by_kind({name: getattr(airlight, name) for name in airlight.__all__})
    for title, names in groups.items():
        parts.append(f"## {title}\n")
        parts += [_entry(name, value) for name, value in names.items()]
    parts.append("## What functions give back\n")
    parts.append(
        "`LightField.lattices` and `LightField.volumes` are tuples of the first two; "
        "`reference.compare` gives the third.\n"
    )
    parts += [_class(cls.__name__, cls) for cls in (LatticeLight, VolumeLight, Metrics)]
    types_table = _table(("type", "is"), TYPES.items())
    parts.append(f"## Types in signatures\n\n{types_table}\n")
    return "\n".join(parts)


def _by_kind(names: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    groups: dict[str, dict[str, Any]] = {
        "Functions": {},
        "Classes": {},
        "Modules": {},
        "Errors": {},
        "Types": {},
    }
    for name, value in names.items():
        if isinstance(value, types.ModuleType):
            groups["Modules"][name] = value
        elif isinstance(value, type):
            groups["Errors" if issubclass(value, Exception) else "Classes"][name] = value
        else:
            groups["Functions" if callable(value) else "Types"][name] = value
    return {title: own for title, own in groups.items() if own}


def _entry(name: str, value: Any) -> str:
    if isinstance(value, types.ModuleType):
        public = {key: getattr(value, key) for key in value.__all__}
        functions = [
            _function(f"{name}.{key}", FORWARDED.get(function, function), "####")
            for key, function in public.items()
            if inspect.isfunction(function)
        ]
        return f"### {name}\n\n{_outside(value)}\n\n" + "\n".join(functions)
    if isinstance(value, type):
        return _class(name, value)
    if inspect.isfunction(value):
        return _function(name, value, "###")
    return f"### {name}\n\n`{_MODULE.sub('', str(value))}`\n"


FORWARDED = {airlight.reference.render: render_reference}
"""Functions that hand all they are given on, and to which: its signature says more."""


def _outside(package: types.ModuleType) -> str:
    """The docstring of a package without the paragraphs that are a map of its modules."""
    inside = {module.name for module in pkgutil.iter_modules(package.__path__)}
    hidden = inside - set(package.__all__)
    paragraphs = (inspect.getdoc(package) or "").split("\n\n")
    kept = [p for p in paragraphs if len(hidden & set(re.findall(r"\w+", p))) < 2]
    return "\n\n".join(_paragraph(p) for p in kept)


_MODULE = re.compile(r"airlight\.([a-z_]+\.)+")


FOR_USERS = (DeviceLifetime,)
"""Bases whose methods users call: they stand among those of the classes derived from them."""


def _class(name: str, cls: type) -> str:
    if issubclass(cls, Exception):
        return f"### {name}\n\n{_prose(cls)}\n"
    # What a base class asks for is between it and the package.
    asked_for = {key for base in cls.__mro__[1:-1] if base not in FOR_USERS for key in vars(base)}
    given = [base for base in cls.__mro__[1:] if base in FOR_USERS]
    methods = [
        _method(key, member)
        for part in (cls, *given)
        for key, member in vars(part).items()
        if not key.startswith("_")
        and key not in asked_for
        and isinstance(member, (types.FunctionType, property, staticmethod, classmethod))
    ]
    body = f"### {name}\n\n```text\n{_signature(name, cls)}\n```\n\n{_prose(cls)}\n{_listed(cls)}"
    return "\n".join([body, *methods])


def _method(key: str, member: Any) -> str:
    if isinstance(member, property):
        return f"#### .{key}\n\n{_prose(member)}\n"
    function = getattr(member, "__func__", member)
    return _function(f".{key}", function, "####")


def _function(name: str, function: Any, level: str) -> str:
    signature = f"```text\n{_signature(name, function)}\n```"
    return f"{level} {name}\n\n{signature}\n\n{_prose(function)}\n{_listed(function)}"


def described(value: Any) -> dict[str, str]:
    """What is said of each parameter of a function or class; "" where its docstring says it.

    A light's parameters are described once, for scene files and Python: by its keys.
    """
    is_light = isinstance(value, type) and issubclass(value, LightType)
    by_key = {key.name: _of_key(key) for key in value.keys} if is_light else {}
    words = set(re.findall(r"\w+", inspect.getdoc(value) or ""))
    found = {}
    for name in inspect.signature(value).parameters:
        if name in by_key:
            found[name] = by_key[name]
        elif name in words or name in ("self", "cls"):
            found[name] = ""
        elif name in COMMON:
            found[name] = COMMON[name]
    return found


def _of_key(key: LightKey) -> str:
    unit = f", {key.unit}" if key.unit else ""
    return f"{key.kind.words}{unit}: {key.doc}"


def _listed(value: Any) -> str:
    """A list of the parameters that the docstring says nothing of."""
    rows = [f"- `{name}`: {said}" for name, said in described(value).items() if said]
    return "\n" + "\n".join(rows) + "\n" if rows else ""


_LONGEST_LINE = 88


def _signature(name: str, value: Any) -> str:
    """NAME(parameters) -> result; a parameter a line where it would be too wide."""
    signature = inspect.signature(value)
    shown, starred = [], False
    for parameter in signature.parameters.values():
        if parameter.name == "self":
            continue
        if parameter.kind is parameter.KEYWORD_ONLY and not starred:
            shown.append("*")
            starred = True
        shown.append(_plain(parameter))
    plain = _short(str(signature.return_annotation))
    result = (
        ""
        if signature.return_annotation is signature.empty or isinstance(value, type)
        else (f" -> {plain}")
    )
    line = f"{name}({', '.join(shown)}){result}"
    if len(line) <= _LONGEST_LINE:
        return line
    return f"{name}(\n    " + ",\n    ".join(shown) + f",\n){result}"


_STARS = {inspect.Parameter.VAR_POSITIONAL: "*", inspect.Parameter.VAR_KEYWORD: "**"}


def _plain(parameter: inspect.Parameter) -> str:
    empty = parameter.empty
    text = _STARS.get(parameter.kind, "") + parameter.name
    if parameter.annotation is not empty:
        text += f": {_short(str(parameter.annotation))}"
    if parameter.default is empty:
        return text
    default = repr(parameter.default)
    return f"{text} = {default if '<' not in default and 'array(' not in default else '...'}"


def _short(annotation: str) -> str:
    return annotation.replace("<class '", "").replace("'>", "").rpartition("airlight.")[2]


def _prose(value: Any) -> str:
    """A docstring as Markdown: paragraphs stay, what is laid out in columns becomes text."""
    paragraphs = (inspect.getdoc(value) or "").split("\n\n")
    return "\n\n".join(_paragraph(p) for p in paragraphs)


def _paragraph(text: str) -> str:
    lines = text.splitlines()
    is_laid_out = any("   " in line.strip() or line.startswith((" ", ">>>")) for line in lines)
    looks_like_code = re.search(r"^(with |for |class |@)", text) is not None
    return f"```text\n{text}\n```" if is_laid_out or looks_like_code else text


def main() -> None:
    """Write every page that changed."""
    for path, text in generated_pages().items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8", newline="\n")
            print(f"written: {path.relative_to(DOCS.parent)}")


if __name__ == "__main__":
    assert set(TECHNIQUES)  # imported for its table of names
    main()
