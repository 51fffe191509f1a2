"""What every test can rely on."""

from __future__ import annotations

import functools
import gc
import importlib.util
import inspect
import os
import random
import re
import shutil
import subprocess
import sys
import textwrap
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from airlight import env
from airlight.app.doctor import llvm_facts
from airlight.errors import DeviceError
from airlight.gpu.commands import Commands
from airlight.gpu.compute import ComputePass
from airlight.gpu.device import Gpu, open_gpu
from airlight.gpu.memory import Buffer, Texture
from airlight.gpu.slots import Slot
from airlight.lighting.view import View
from airlight.reference.mitsuba_llvm import find_llvm
from airlight.scene import Camera, Geometry, Material, Mesh, Scene
from airlight.surface.geometry import GpuScene

REPOSITORY = Path(__file__).parents[1]
# The state of each file's random generators before its first test, by module and name.
_BEGINNINGS: dict[tuple[str, str], Any] = {}
# Which adapter the tests run on, and which code paths they take, is the caller's choice.
_ADAPTER, _PATHS = env.value("AIRLIGHT_ADAPTER"), env.value("AIRLIGHT_PATHS")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--slow", action="store_true", help="run the tests that take minutes, too")
    parser.addoption(
        "--shuffle",
        type=int,
        metavar="SEED",
        help="files in another order, and the tests in each, too: none may lean on another",
    )


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A test marked `both_paths` runs once on the paths of GPUs and once on those of CPUs."""
    if metafunc.definition.get_closest_marker("both_paths"):
        metafunc.parametrize("paths", ("gpu", "cpu"), indirect=True, scope="module")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if (seed := config.getoption("--shuffle")) is not None:
        _shuffle(items, seed)
    for item in items:
        if reason := _why_not(item, is_slow_welcome=config.getoption("--slow")):
            item.add_marker(pytest.mark.skip(reason=reason))


def pytest_configure() -> None:
    """While modules are imported and tests made, there is next to no garbage to look for."""
    gc.disable()


def pytest_collection_finish() -> None:
    """What modules and tests are made of lives to the end: collections need not look at it."""
    gc.collect()
    gc.freeze()
    gc.enable()


def _why_not(item: pytest.Item, *, is_slow_welcome: bool) -> str:
    """Why a test is skipped, and what to do about it; "" where it runs."""
    if item.get_closest_marker("slow") and not is_slow_welcome:
        return "takes minutes: run with --slow"
    missing = [(n, r) for m in item.iter_markers("needs") for n in m.args if (r := _remedy(n))]
    names = " and ".join(n if isinstance(n, str) else n[0] for n, _ in missing)
    return f"needs {names}: {', '.join(dict.fromkeys(r for _, r in missing))}" if missing else ""


_MODULES = {"usd_core": "pxr"}
"""Of packages whose module has another name."""


@functools.cache
def _remedy(need: str | tuple[str, ...]) -> str:
    """What brings something that `pytest.mark.needs` names, "" where it is there.

    UsageError for a module that no extra of pyproject.toml brings: it would be skipped for ever.
    """
    if need == "libLLVM":
        return "" if find_llvm() else str(llvm_facts()["get_it"])
    if isinstance(need, tuple):
        return "" if any(map(shutil.which, need)) else f"apt install {need[0].lower()}"
    if need not in _extras():
        raise pytest.UsageError(f"no extra of pyproject.toml brings '{need}', which a test needs")
    module = _MODULES.get(need, need)
    return "" if importlib.util.find_spec(module) else f'pip install ".[{_extras()[need]}]"'


@functools.cache
def _extras() -> dict[str, str]:
    """The first extra that brings a module, by the module's name."""
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]
    brought: dict[str, str] = {}
    for extra, requirements in project["optional-dependencies"].items():
        for requirement in requirements:
            name = re.split(r"[^\w-]", requirement)[0].replace("-", "_")
            brought.setdefault(name, extra)
    return brought


def _shuffle(items: list[pytest.Item], seed: int) -> None:
    """In place. A file's tests stay together: what they share is made once for them."""
    files: dict[str, list[pytest.Item]] = {}
    for item in items:
        files.setdefault(item.nodeid.split("::")[0], []).append(item)
    order, chance = sorted(files), random.Random(seed)
    chance.shuffle(order)
    for name in order:
        chance.shuffle(files[name])
    items[:] = [item for name in order for item in files[name]]


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Scenes, volumes and environment maps of others, beside the repository."""
    folder = REPOSITORY.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("the data of others is not beside the repository")
    return folder


@pytest.fixture(scope="module")
def paths(request: pytest.FixtureRequest) -> str:
    """The code paths that a test takes: the caller's, or each in turn where it is `both_paths`."""
    return str(getattr(request, "param", _PATHS))


@pytest.fixture(autouse=True)
def _no_switches(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory, paths: str
):
    """No AIRLIGHT_* variable of the caller's reaches a test, and no test writes to his cache.

    But the adapter and the code paths that he chose do.
    """
    for name in [name for name in os.environ if name.startswith("AIRLIGHT_")]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("AIRLIGHT_ADAPTER", _ADAPTER)
    monkeypatch.setenv("AIRLIGHT_PATHS", paths)
    monkeypatch.setenv("AIRLIGHT_CACHE", str(tmp_path_factory.getbasetemp() / "airlight-cache"))


@pytest.fixture(autouse=True)
def _same_numbers(request: pytest.FixtureRequest) -> None:
    """A file's own random numbers restart for each test: none depends on those run before."""
    for name, value in vars(request.module).items():
        if isinstance(value, np.random.Generator):
            bits = value.bit_generator
            bits.state = _BEGINNINGS.setdefault((request.module.__name__, name), bits.state)


@pytest.fixture(autouse=True)
def _no_garbage(request: pytest.FixtureRequest) -> None:
    """Where memory on the device is counted, what earlier tests dropped in circles is gone."""
    if "allocated_bytes" in inspect.getsource(request.module):
        gc.collect()


@pytest.fixture(scope="module")
def gpu(paths: str) -> Gpu:
    """The device, opened once for each adapter and paths, or a skip with the reason."""
    try:
        return open_gpu(_ADAPTER, paths)
    except DeviceError as error:
        pytest.skip(f"no graphics device: {error}")


@pytest.fixture
def commands(gpu: Gpu) -> Commands:
    """What encodes; `submit` before reading."""
    return Commands(gpu)


@pytest.fixture
def owned() -> Iterator[Callable[[Any], Any]]:
    """owned(thing) -> thing, which lives until the test's end, and its memory no longer."""
    things: list[Any] = []

    def keep(thing: Any) -> Any:
        things.append(thing)
        return thing

    yield keep
    for thing in reversed(things):
        if isinstance(thing, Buffer | Texture):
            thing.release()


_CHILD = """
import faulthandler, numpy as np, airlight as al
faulthandler.enable()
corners = np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], np.float32)
quad = al.Geometry(corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
small = {"resolution": 4, "shadow_resolution": 16, "lamp_resolution": 16, "surfels": 100}
scene = al.Scene((al.Mesh(quad),), (al.PointLight((0, 2, 0), (5, 5, 5)),),
                 camera=al.Camera((0, 2, 3), (0, 0, 0)))
def made():
    return al.Renderer(scene, "direct", (16, 16), settings=small)
"""


@pytest.fixture
def child(gpu: Gpu) -> Callable[[str], list[str]]:
    """child(code) -> what it prints, line by line, in a process of its own that may crash or hang.

    It has `al`, `np`, a `scene` of a quad and a light, and `made()`, a Renderer of that; its lines
    on stderr, and how it ended where that was not well, come last. Libraries of OpenGL, which
    code here may load, keep quiet: what they warn of is how a machine's Mesa was installed.
    """

    def run(code: str) -> list[str]:
        done = subprocess.run(
            [sys.executable, "-c", _CHILD + textwrap.dedent(code)],
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
            env={**os.environ, "EGL_LOG_LEVEL": "fatal"},
        )
        ended = [f"exit code {done.returncode}"] if done.returncode else []
        return done.stdout.splitlines() + done.stderr.splitlines() + ended

    return run


@pytest.fixture
def kernel(gpu: Gpu, tmp_path: Path) -> Callable[..., ComputePass]:
    """kernel(wgsl, slots) -> ComputePass made of a file `kernel.wgsl` of its own."""

    def make(wgsl: str, slots: tuple[Slot, ...], **named: Any) -> ComputePass:
        path = tmp_path / "kernel.wgsl"
        path.write_text(wgsl)
        members = {"slots": slots, "workgroup": (64, 1, 1), "file": str(path), **named}
        return type("Kernel", (ComputePass,), {"__module__": __name__, **members})(gpu)

    return make


def _square(centre: Any, u: Any, v: Any, material: Material | None = None, **geometry: Any) -> Mesh:
    c, u, v = (np.asarray(a, dtype=np.float64) for a in (centre, u, v))
    corners = np.array([c - u - v, c + u - v, c + u + v, c - u + v], np.float32)
    made = Geometry(corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32), **geometry)
    return Mesh(made, material or Material(specular=0.0))


@pytest.fixture(scope="session")
def square() -> Callable[..., Mesh]:
    """square(centre, u, v, material): a parallelogram of half edges u and v, facing u x v."""
    return _square


def _camera_rays(camera: Camera, size: tuple[int, int]) -> np.ndarray:
    eye, target, up = (np.array(a) for a in (camera.position, camera.target, camera.up))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    half = np.tan(np.radians(camera.fov_y_deg) / 2.0)
    width, height = size
    x = ((np.arange(width) + 0.5) / width * 2.0 - 1.0) * half * width / height
    y = ((np.arange(height) + 0.5) / height * 2.0 - 1.0) * half
    rays = forward + x[None, :, None] * right + y[:, None, None] * down
    return np.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True))


@pytest.fixture(scope="session")
def camera_rays() -> Callable[[Camera, tuple[int, int]], np.ndarray]:
    """camera_rays(camera, (width, height)) -> (H, W, 3) unit, through the pixels' centres."""
    return _camera_rays


class Look:
    """A scene as its camera sees it: the G-buffer is drawn."""

    def __init__(self, gpu: Gpu, owned: Callable[[Any], Any], scene: Scene, size: Any) -> None:
        self.gpu, self.scene, self.size = gpu, scene, size
        self.commands = Commands(gpu)
        self.meshes = owned(GpuScene(gpu, scene))
        self.view = owned(View(gpu, size))
        self.view.aim(scene.camera)
        self.view.gbuffer.encode(self.commands, self.meshes, self.view.clip_from_world)
        self.commands.submit()

    def directions(self) -> np.ndarray:
        """(H, W, 3) unit, through the pixels' centres."""
        return _camera_rays(self.scene.camera, self.size)

    def read(self, texture: Any) -> np.ndarray:
        """(H, W, 3), with everything encoded before."""
        self.commands.submit()
        return np.asarray(texture.read()[..., :3].astype(np.float64))


@pytest.fixture
def look(gpu: Gpu, owned: Callable[[Any], Any]) -> Callable[..., Look]:
    """look(scene, (width, height)) -> Look."""

    def seen(scene: Scene, size: tuple[int, int] = (24, 16)) -> Look:
        return Look(gpu, owned, scene, size)

    return seen
