"""The house: who may import whom, sizes, citations, packaging. See docs/architecture.md."""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from airlight import env
from airlight.gpu.source import LIBRARIES

REPOSITORY = Path(__file__).parents[1]
SOURCE = REPOSITORY / "src" / "airlight"
TESTS = REPOSITORY / "tests"

LONGEST_MODULE, LONGEST_FUNCTION, LONGEST_SHADER, MOST_PARAMETERS = 300, 55, 250, 7
"""Lines, and parameters beside self. The aim is 300, 40, 200 and 6; here the build fails."""
LONG_FOR_A_REASON = {"reference/tracer_kernel.py": 342}
"""Lines of modules that stay whole. Numba's cache on disk holds the compiled entry point with all
that it calls, and sees changes of the entry point's own file only (its documentation, "Notes on
Caching"): a kernel in two files would run old code after a change of the second.
"""

LAYERS = (
    "maths",
    "scene",
    "gpu",
    "surface",
    "rays",
    "lattice",
    "area",
    "lighting",
    "fields",
    "media",
)
"""Rooms from the bottom up: data flows from each to those behind it."""
SOLVERS = ("gather", "lpv", "scatter", "pop")
_MAY_IMPORT: dict[str, tuple[str, ...]] = {
    **{room: LAYERS[:level] for level, room in enumerate(LAYERS)},
    "gpu": (),
    **dict.fromkeys(SOLVERS, LAYERS),
    "techniques": (*LAYERS, *SOLVERS),
    "display": ("maths", "scene", "gpu", "surface", "lattice", "lighting"),
    "reference": ("maths", "scene"),
}
"""Room -> the other rooms it may import. Everyone may import `errors`, which imports nothing,
and `env`, which imports `errors`; what is not listed may import all but `figures` and `app`."""
TOP = ("figures", "app")


def modules() -> list[Path]:
    return sorted(SOURCE.rglob("*.py"))


def shaders() -> list[Path]:
    return sorted(SOURCE.rglob("*.wgsl"))


def relative(path: Path) -> str:
    return path.relative_to(REPOSITORY).as_posix()


def dotted(path: Path) -> str:
    """src/airlight/scene/io/toml.py -> airlight.scene.io.toml"""
    parts = path.relative_to(SOURCE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@pytest.fixture(scope="module", autouse=True)
def _trees_go():
    """A million nodes would slow every collection of garbage after this file."""
    yield
    imported_by.cache_clear()
    nodes.cache_clear()
    tree.cache_clear()


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"), filename=str(path))


@cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """All of a module's tree, walked once."""
    return tuple(ast.walk(tree(path)))


@cache
def imported_by(path: Path) -> frozenset[str]:
    """Absolute dotted names that a file imports anywhere, `from a import b` as a and a.b."""
    names: set[str] = set()
    package = dotted(path) if path.name == "__init__.py" else dotted(path).rpartition(".")[0]
    for node in nodes(path):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*parts, base] if base else parts)
            names |= {base, *(f"{base}.{alias.name}" for alias in node.names)}
    return frozenset(names)


def room(name: str) -> str:
    """airlight.scene.io.toml -> scene; a module at the top is its own room."""
    parts = name.split(".")
    return parts[1] if len(parts) > 1 else ""


def rooms() -> set[str]:
    """Folders and modules directly under airlight."""
    return {path.stem for path in SOURCE.iterdir() if path.is_dir() or path.suffix == ".py"}


def is_allowed(importer: str, imported: str) -> bool:
    if imported in (importer, "errors", "env"):
        return True
    if importer in _MAY_IMPORT:
        return imported in _MAY_IMPORT[importer]
    return imported not in TOP or importer in (*TOP, "__main__")


def test_imports_go_one_way():
    known = rooms()
    broken = [
        f"{relative(path)} ({room(dotted(path))}) imports {name}"
        for path in modules()
        for name in sorted(imported_by(path))
        if name.startswith("airlight.") and room(name) in known
        if room(dotted(path)) and not is_allowed(room(dotted(path)), room(name))
    ]
    assert not broken, "\n".join(broken)


def test_the_import_rule_catches_what_it_forbids():
    assert not is_allowed("lpv", "scatter")
    assert not is_allowed("maths", "scene")
    assert not is_allowed("gpu", "maths")
    assert not is_allowed("reference", "gpu")
    assert not is_allowed("rendering", "app")
    assert not is_allowed("lattice", "lighting")
    assert not is_allowed("lighting", "media")
    assert not is_allowed("pop", "techniques")
    assert is_allowed("lpv", "lattice")
    assert is_allowed("app", "reference")


def test_only_gpu_imports_wgpu():
    broken = [
        relative(path)
        for path in modules()
        if room(dotted(path)) != "gpu"
        if any(name == "wgpu" or name.startswith("wgpu.") for name in imported_by(path))
    ]
    assert not broken, "\n".join(broken)


_CALLERS_NAME_THEM = "public: each parameter is an option of its own, which callers name"
_CLOSED_FORM = "the physical quantities of a formula, in its own symbols"
_COMPILED = "compiled by Numba, which takes numbers and arrays, no objects"
MANY_FOR_A_REASON = {
    "scene.io.load": _CALLERS_NAME_THEM,
    "rendering.frame": _CALLERS_NAME_THEM,
    "rendering.render": _CALLERS_NAME_THEM,
    "reference.mitsuba.render": _CALLERS_NAME_THEM,
    "reference.mitsuba.render_layers": _CALLERS_NAME_THEM,
    "reference.mitsuba_scene.export": _CALLERS_NAME_THEM,
    "reference.tracer.trace": _CALLERS_NAME_THEM,
    "reference.tracer.fluence": _CALLERS_NAME_THEM,
    "gpu.memory.Texture": "the fields of WebGPU's texture descriptor",
    "surface.light_views.perspective": _CLOSED_FORM,
    "reference.quadrature.point_single_scatter": _CLOSED_FORM,
    "reference.quadrature.directional_single_scatter": _CLOSED_FORM,
    "reference.quadrature.box_single_scatter_intensity": _CLOSED_FORM,
    "maths.ordinate_hops.propagate": _CLOSED_FORM,
    "reference.tracer_kernel.run_batch": _COMPILED,
    "reference.tracer_kernel._deposit": _COMPILED,
    "reference.tracer_kernel._record": _COMPILED,
}
"""By module and function, or by module and class where it is made."""


def functions(path: Path) -> Iterator[tuple[str, int]]:
    """(name, lines) of every function, decorators and docstring counted."""
    for node in nodes(path):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            first = min([node.lineno, *(d.lineno for d in node.decorator_list)])
            yield node.name, (node.end_lineno or first) - first + 1


def line_count(path: Path) -> int:
    return len(path.read_text(encoding="utf-8").splitlines())


def test_nothing_is_too_long():
    long = [
        f"{relative(path)}: {line_count(path)} lines"
        for paths, longest in ((modules(), LONGEST_MODULE), (shaders(), LONGEST_SHADER))
        for path in paths
        if line_count(path) > LONG_FOR_A_REASON.get(path.relative_to(SOURCE).as_posix(), longest)
    ]
    long += [
        f"{relative(path)}: {name}() {lines} lines"
        for path in modules()
        for name, lines in functions(path)
        if lines > LONGEST_FUNCTION
    ]
    assert not long, "\n".join(long)


def parameters(path: Path) -> Iterator[tuple[str, int]]:
    """(module.function or module.Class, how many parameters beside self) of every function."""
    module = dotted(path).removeprefix("airlight.")
    makers = {
        id(member): node.name
        for node in nodes(path)
        if isinstance(node, ast.ClassDef)
        for member in node.body
        if isinstance(member, ast.FunctionDef) and member.name == "__init__"
    }
    for node in nodes(path):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            a = node.args
            named = [x for x in a.posonlyargs + a.args + a.kwonlyargs if x.arg not in _OWN]
            count = len(named) + (a.vararg is not None) + (a.kwarg is not None)
            yield f"{module}.{makers.get(id(node), node.name)}", count


_OWN = ("self", "cls")


def test_no_function_takes_too_much():
    """What belongs together is one frozen dataclass that means something."""
    many = [
        f"{name}() takes {count}"
        for path in modules()
        for name, count in parameters(path)
        if count > MOST_PARAMETERS and name not in MANY_FOR_A_REASON
    ]
    assert not many, "\n".join(many)


def test_parameters_are_counted(tmp_path, monkeypatch):
    monkeypatch.setattr(f"{__name__}.dotted", lambda path: "airlight.room.module")
    path = tmp_path / "module.py"
    path.write_text(
        "class Made:\n    def __init__(self, a, b, *, c=1, **more): ...\n"
        "def done(a, /, *rest): ...\n"
    )
    assert dict(parameters(path)) == {"room.module.Made": 4, "room.module.done": 2}


def test_every_module_has_a_test():
    """A test file imports it, names it dotted (airlight.scene.mesh), or mirrors its place.

    A module that tested ones import, of its folder or its room in parts, is tested through them.
    """
    files = [path for path in sorted(TESTS.rglob("*.py")) if path.name != "test_house.py"]
    # One search of all tests for dotted names, of which every beginning counts as named.
    named = {
        ".".join(name.split(".")[:length])
        for path in files
        for name in names_of_modules(path.read_text(encoding="utf-8"))
        for length in range(1, name.count(".") + 2)
    }
    tested = {
        path
        for path in modules()
        if dotted(path) in named
        or (TESTS / path.relative_to(SOURCE)).with_name(f"test_{path.name}").exists()
    }
    reached: set[Path] = set()
    while tested != reached:
        reached = set(tested)
        used = {name for path in reached for name in imported_by(path) if _same_room(name, path)}
        tested |= {path for path in modules() if dotted(path) in used}
    missing = [
        relative(path)
        for path in modules()
        if path not in tested and not _is_only_a_docstring(path)
    ]
    assert not missing, "\n".join(missing)


_ROOMS_IN_PARTS = ("media", "pop")
"""Rooms whose folders are parts of one method, tested through what puts them together."""


def _same_room(name: str, path: Path) -> bool:
    """Whether a module imports another of its own folder, or of its own room in parts."""
    own, other = dotted(path).split(".")[:-1], name.split(".")[:-1]
    is_in_parts = own[:2] == other[:2] and room(name) in _ROOMS_IN_PARTS
    return own == other or is_in_parts


def names_of_modules(text: str) -> set[str]:
    """What a test names dotted, and what it imports from a package. Its text is searched only:
    the trees of all tests would take seconds."""
    names = set(re.findall(r"\bairlight(?:\.\w+)*", text))
    for package, imported in re.findall(
        r"\bfrom +(airlight[.\w]*) +import +(\([^)]*\)|[^\n]*)", text
    ):
        names |= {f"{package}.{name}" for name in re.findall(r"\w+", imported)}
    return names


def test_names_of_modules_are_found():
    text = (
        "from airlight import scenes\nfrom airlight.pop import (\n    walls,\n    grid as g,\n)\n"
    )
    assert {"airlight.scenes", "airlight.pop.walls", "airlight.pop.grid"} <= names_of_modules(text)
    assert "airlight.maths.tone" in names_of_modules(
        'monkeypatch.setattr("airlight.maths.tone", 1)'
    )


def _is_only_a_docstring(path: Path) -> bool:
    """A package's __init__ that names its rooms, and perhaps re-exports, does nothing to test."""
    harmless = (ast.Expr, ast.Import, ast.ImportFrom, ast.Assign, ast.AnnAssign)
    return path.name == "__init__.py" and all(isinstance(n, harmless) for n in tree(path).body)


def parts_of(package: Path) -> list[str]:
    """Names of the modules and packages directly in a package."""
    folder = package.parent
    inner = [path.parent.name for path in folder.glob("*/__init__.py")]
    return sorted([path.stem for path in folder.glob("*.py") if path != package] + inner)


def unnamed(parts: list[str], text: str) -> list[str]:
    """Those that a text names neither as a word nor by a wildcard such as `gltf_*`."""
    words = set(re.findall(r"\w+\*?", text))
    prefixes = tuple(word[:-1] for word in words if word.endswith("*"))
    return [part for part in parts if part not in words and not part.startswith(prefixes)]


def test_a_package_says_what_each_of_its_modules_holds():
    """In its docstring; the package's own is for its users, so the map names its rooms."""
    missing = []
    for package in (path for path in modules() if path.name == "__init__.py"):
        text = ast.get_docstring(tree(package)) or ""
        if package.parent == SOURCE:
            text = (REPOSITORY / "docs" / "architecture.md").read_text(encoding="utf-8")
        missing += [f"{relative(package)}: {name}" for name in unnamed(parts_of(package), text)]
    assert not missing, "say what they hold:\n" + "\n".join(missing)


def test_a_module_is_named_as_a_word_or_by_its_beginning():
    text = "toml, obj_parse -> scene; gltf_* (buffers) and mitsuba*"
    assert unnamed(["toml", "scene", "gltf_mesh", "mitsuba", "mitsuba_xml"], text) == []
    assert unnamed(["obj", "gltf", "parse", "tom"], text) == ["obj", "gltf", "parse", "tom"]
    assert unnamed(["any"], "") == ["any"]


OPENS = "scene/io/files.py"
"""The one module that opens files of the user's to read."""
_READS_ITS_OWN = {
    "gpu/compute.py": "shaders of the package",
    "gpu/raster.py": "shaders of the package",
    "gpu/source.py": "shaders of the package",
    "maths/area_light.py": "a table of the package",
    "app/view/page.py": "the viewer's page, of the package",
    "app/bench/child.py": "what the system says of the process",
    "reference/mitsuba_child.py": "what a child of ours wrote into a folder of ours",
    "reference/mitsuba_process.py": "what the parent wrote into a folder of ours",
    "app/sequence/frames.py": "a frame just written into a folder of ours",
    "scene/io/writing.py": "what was just written into a folder of ours",
}
_READERS = frozenset(
    [
        "open",
        "fdopen",
        "read_bytes",
        "read_text",
        "load",
        "fromfile",
        "memmap",
        "genfromtxt",
        "loadtxt",
        "File",
        "ZipFile",
        "parse",
        "imread",
        "mmap",
    ]
)
_READERS_ARE_FROM = frozenset(
    [
        "os",
        "io",
        "np",
        "numpy",
        "PIL",
        "Image",
        "OpenEXR",
        "av",
        "trimesh",
        "zipfile",
        "gzip",
        "ElementTree",
        "imageio",
        "path",
        "file",
        "source",
        "mmap",
    ]
)
_OF_A_CHECKED_FILE = frozenset(("BytesIO", "regular_file", "stream"))


def opens_for_reading(node: ast.Call) -> bool:
    """Whether a call opens a file to read, other than by `files`, from memory, or to write."""
    if isinstance(node.func, ast.Name):
        name, of = node.func.id, ""
        is_reader = name == "open"
    elif isinstance(node.func, ast.Attribute):
        name, base = node.func.attr, node.func.value
        of = base.id if isinstance(base, ast.Name) else getattr(base, "attr", "")
        # Whatever has these methods is a path; the others' names are used for much else.
        modes = [a.value for a in node.args[:1] if isinstance(a, ast.Constant)]
        is_reader = name in ("read_bytes", "read_text") or (
            name in _READERS and (of in _READERS_ARE_FROM or modes in (["r"], ["rb"]))
        )
    else:
        return False
    texts = [
        a.value
        for a in [*node.args, *(k.value for k in node.keywords)]
        if isinstance(a, ast.Constant) and isinstance(a.value, str)
    ]
    is_written = any(set(text) <= set("wxab+t") and set(text) & set("wxa") for text in texts)
    made_by = {
        n.id if isinstance(n, ast.Name) else n.attr
        for a in node.args
        for n in ast.walk(a)
        if isinstance(n, (ast.Name, ast.Attribute))
    }
    is_made = name == "File" and len(node.args) > 1  # OpenEXR's of a header and channels
    return is_reader and not is_written and not made_by & _OF_A_CHECKED_FILE and not is_made


def test_one_module_opens_files_for_reading():
    found = [
        f"{relative(path)}:{node.lineno}: {ast.unparse(node)[:60]}"
        for path in modules()
        if path.relative_to(SOURCE).as_posix() not in (OPENS, *_READS_ITS_OWN)
        for node in nodes(path)
        if isinstance(node, ast.Call) and opens_for_reading(node)
    ]
    assert not found, f"read these by {OPENS}:\n" + "\n".join(found)


@pytest.mark.parametrize(
    ("text", "opens"),
    [
        ("open(p)", True),
        ("p.open('rb')", True),
        ("path.open('rb')", True),
        ("path.open('wb')", False),
        ("open(p, mode='w')", False),
        ("x.read_text()", True),
        ("np.load(p)", True),
        ("PIL.Image.open(p)", True),
        ("zipfile.ZipFile(p)", True),
        ("PIL.Image.open(io.BytesIO(raw))", False),
        ("OpenEXR.File(str(path))", True),
        ("OpenEXR.File(header, channels).write(str(path))", False),
        ("folder.open(asked)", False),
        ("OpenEXR.open(str(regular_file(path)))", False),
        ("os.open(path, 0)", True),
    ],
)
def test_the_rule_of_opening_catches_what_it_forbids(text, opens):
    call = next(n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Call))
    assert opens_for_reading(call) == opens


_CITATION = re.compile(r"\b[A-Z][A-Za-z]+(?:18|19|20)\d\d[a-z]?\b")
_IN_PROSE = re.compile(
    r"\b((?:Van )?[A-Z][a-zé]+)"
    r"( et al\.|(?:, [A-Z]\w+)* and [A-Z]\w+|(?:, [A-Z]\w+){2,})? \(?((?:18|19|20)\d\d)\b(?!-\d)"
)
"""First author, others, year: Chen et al. 2011, Max 1995, Kaplanyan and Dachsbacher (2010)."""
_NOT_A_CITATION = {"Rec2020", "Below1900", "October2026"}


def known_works() -> set[str]:
    """The keys of the bibliography."""
    text = (REPOSITORY / "docs" / "references.bib").read_text(encoding="utf-8")
    keys: list[str] = re.findall(r"^@\w+\{([^,]+),", text, re.MULTILINE)
    assert len(set(keys)) == len(keys)
    return set(keys)


def cited_in_prose(text: str) -> set[str]:
    """The keys of works that a text names by author and year, over the ends of lines, too."""
    flat = re.sub(r"\s*\n[\s/#]*", " ", text)
    keys = {first.replace(" ", "") + year for first, _, year in _IN_PROSE.findall(flat)}
    return keys - _NOT_A_CITATION


def test_every_citation_is_known():
    known = known_works() | _NOT_A_CITATION
    assert known >= {"Kaplanyan2010", "Billeter2012", "Elek2014"}
    unknown = [
        f"{relative(path)}: {key}"
        for path in [*modules(), *shaders(), *sorted(TESTS.rglob("test_*.py"))]
        if path != Path(__file__)
        for key in sorted(set(_CITATION.findall(path.read_text(encoding="utf-8"))))
        if key not in known
    ]
    for page in [*REPOSITORY.glob("*.md"), *(REPOSITORY / "docs").rglob("*.md")]:
        cited = cited_in_prose(page.read_text(encoding="utf-8"))
        unknown += [f"{relative(page)}: {key}" for key in sorted(cited - known)]
    assert not unknown, "\n".join(unknown)


def test_code_cites_by_keys():
    prose = [
        f"{relative(path)}: {key}"
        for path in [*modules(), *shaders()]
        if path.relative_to(SOURCE).as_posix() != "figures/gallery.py"  # its headings
        for key in sorted(cited_in_prose(path.read_text(encoding="utf-8")))
    ]
    assert not prose, "cite these by the keys of docs/references.bib:\n" + "\n".join(prose)


def test_citations_in_prose_are_found():
    text = (
        "after Chen et\n    // al. 2011, (Max 1995), Kay and Kajiya 1986; Lee, Moon and Sun (2001)"
    )
    assert cited_in_prose(text) == {"Chen2011", "Max1995", "Kay1986", "Lee2001"}
    assert not cited_in_prose("on 2026-11-21, at 1900 K, CIE 1931, of Chen2011")


def is_public(name: str) -> bool:
    return not name.startswith("_")


def undocumented(path: Path) -> Iterator[str]:
    """The module, its public classes and functions, and public methods, where undocumented."""
    if not ast.get_docstring(tree(path)):
        yield f"{relative(path)}: the module"
    pending: list[tuple[str, ast.AST]] = [("", tree(path))]
    while pending:
        prefix, parent = pending.pop()
        for node in ast.iter_child_nodes(parent):
            if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
                continue
            if not is_public(node.name):
                continue
            if not ast.get_docstring(node) and not _inherits_its_meaning(node):
                yield f"{relative(path)}: {prefix}{node.name}"
            if isinstance(node, ast.ClassDef):
                pending.append((f"{prefix}{node.name}.", node))


def _inherits_its_meaning(node: ast.AST) -> bool:
    """click's overrides and properties' setters say nothing new."""
    decorators = getattr(node, "decorator_list", [])
    is_setter = any(isinstance(d, ast.Attribute) and d.attr == "setter" for d in decorators)
    return is_setter or getattr(node, "name", "") in ("convert", "list_commands", "get_command")


def test_public_names_say_what_they_mean():
    bare = [line for path in modules() for line in undocumented(path)]
    assert not bare, "\n".join(bare)


def test_what_a_test_needs_is_said_by_one_marker():
    """`needs` names the remedy; `importorskip` says that an import failed."""
    own = {Path(__file__), Path(__file__).with_name("conftest.py")}
    skips = re.compile(r"importorskip\(|skipif\([^)]*(find_spec|which|find_llvm)\(")
    found = [
        relative(path)
        for path in sorted(set(Path(__file__).parent.rglob("*.py")) - own)
        if skips.search(path.read_text(encoding="utf-8"))
    ]
    assert not found, found


def test_every_switch_is_in_the_table():
    known = {switch.name for switch in env.SWITCHES}
    used = {
        f"{relative(path)}: {name}"
        for path in modules()
        for name in re.findall(r"\bAIRLIGHT_[A-Z_]+\b", path.read_text(encoding="utf-8"))
        if name not in known
    }
    assert not used, "\n".join(sorted(used))


def tracked_files() -> list[Path]:
    done = subprocess.run(
        ["git", "ls-files", "-z"], cwd=REPOSITORY, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        pytest.skip("not a git checkout")
    return [REPOSITORY / name for name in done.stdout.split("\0") if name]


_MACHINE_PATHS = ("/" + "work/", "/" + "root/", "/" + "home/", ".py" + "env/")


def test_no_file_names_the_machine_it_was_made_on():
    found = []
    for path in tracked_files():
        try:
            text = path.read_text(encoding="utf-8")
        except (UnicodeDecodeError, OSError):  # an image, or deleted in the working tree
            continue
        found += [f"{relative(path)}: {place}" for place in _MACHINE_PATHS if place in text]
    assert not found, "\n".join(found)


_TOP_LEVEL = re.compile(
    r"^(?:@\w+(?:\([^)]*\))?\s*)*(?:fn|struct|const|override|alias|var(?:<[^>]*>)?)\s+(\w+)",
    re.MULTILINE,
)
"""The name of a declaration of WGSL, which stands at the beginning of a line."""


def idle_uses(shader: str, libraries: dict[str, str]) -> list[str]:
    """Parts that a shader's `//! use` lines name and of whose declarations it names none."""
    words = set(re.findall(r"\w+", _without_comments(shader)))
    return [
        part
        for part in re.findall(r"^//! use (\w+)\s*$", shader, re.MULTILINE)
        if not words & set(_TOP_LEVEL.findall(_without_comments(libraries[part])))
    ]


def _without_comments(shader: str) -> str:
    return re.sub(r"//.*", "", shader)


def test_shaders_use_what_they_name():
    """What a part itself needs, it uses; so a `//! use` line is for what stands below it."""
    libraries = {
        path.stem: path.read_text(encoding="utf-8")
        for folder in LIBRARIES
        for path in folder.glob("*.wgsl")
    }
    idle = [
        f"{relative(path)}: //! use {part}"
        for path in shaders()
        for part in idle_uses(path.read_text(encoding="utf-8"), libraries)
    ]
    assert not idle, "\n".join(idle)


def test_an_idle_use_is_found():
    libraries = {
        "one": "// two\nconst ONE = 1;\n",
        "two": "@must_use fn two() -> i32 {\n    let ONE = 2;\n    return ONE;\n}\n",
        "three": "struct Three {\n    three: i32,\n}\nvar<private> third: Three;\n",
    }
    head = "//! use one\n//! use two\n//! use three\n"
    assert idle_uses(head + "fn f() { return; }  // ONE two Three", libraries) == [*libraries]
    assert idle_uses(head + "fn f() -> i32 { return ONE; }", libraries) == ["two", "three"]
    assert idle_uses(head + "fn f() { third.three = two(); }", libraries) == ["one"]


@pytest.mark.needs("hatchling")
def test_the_wheel_carries_every_shader_and_the_type_marker(tmp_path):
    import zipfile

    from hatchling.builders import wheel as builders

    (wheel,) = builders.WheelBuilder(str(REPOSITORY)).build(
        directory=str(tmp_path), versions=["standard"]
    )
    carried = set(zipfile.ZipFile(wheel).namelist())
    wanted = {
        path.relative_to(SOURCE.parent).as_posix()
        for path in [*modules(), *shaders(), *SOURCE.rglob("web/*"), SOURCE / "py.typed"]
    }
    assert wanted <= carried, sorted(wanted - carried)
    assert not [name for name in carried if name.startswith("tests/")]


def test_what_cpu_adapters_do_otherwise_is_in_one_list():
    """`gpu.code_paths.CodePaths`: each of its fields selects something, and nothing else does."""
    texts = {relative(path).removeprefix("src/airlight/"): path.read_text() for path in modules()}
    listed = texts.pop("gpu/code_paths.py")
    fields = re.findall(r"^    (\w+): (?:bool|int|tuple\[int, int\])$", listed, re.MULTILINE)
    assert len(fields) > 5
    for name in fields:
        assert f"    {name} " in listed, f"{name} is not described"
        assert any(f"paths.{name}" in text for text in texts.values()), f"nobody asks {name}"
    # What is true of the adapter itself, or is told to people.
    asked = {name for name, text in texts.items() if re.search(r"\.is_cpu\b|paths\.name\b", text)}
    apart = {"gpu/device.py", "gpu/commands.py", "rendering.py"}
    assert {name for name in asked - apart if not name.startswith("app/")} == set()
