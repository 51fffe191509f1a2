"""Choose a graphics adapter and open it.

WebGPU on Vulkan, Metal or DirectX 12; OpenGL adapters are never used, because the driver
falls back to OpenGL silently where Vulkan is missing and then lacks what we need. OpenGL is not
even loaded, unless another user of wgpu in the process has done so before.
"""

from __future__ import annotations

import copy
import os
import tempfile
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import wgpu
from wgpu.backends.wgpu_native import ffi
from wgpu.backends.wgpu_native.extras import set_instance_extras

from ..errors import DeviceError
from .asked import Asked, asked_features, asked_limits, chosen_asked, has_uniforms_in_storage
from .code_paths import CodePaths, chosen_paths
from .failures import OPEN_REMEDY, TO_FIND, TO_OPEN, Guarded, check_memory, is_alive, lost
from .pipelines import Pipelines
from .process import enter_driver
from .quick_types import declare_only_what_is_named
from .scope import Memory, Scope
from .uploads import Uploads

NO_DRIVER_REMEDY = (
    "Install a Vulkan driver: your GPU vendor's, or the software one "
    "(Debian and Ubuntu: apt install mesa-vulkan-drivers)"
)
_BACKENDS = ("Vulkan", "Metal", "DX12")
_PREFERENCE = ("DiscreteGPU", "IntegratedGPU", "VirtualGPU", "CPU", "Unknown", "Other")
declare_only_what_is_named(ffi)


@dataclass(frozen=True)
class AdapterInfo:
    """One graphics adapter. `adapter_type` is DiscreteGPU, IntegratedGPU, VirtualGPU or CPU."""

    name: str
    adapter_type: str
    backend: str
    driver: str
    vendor: str
    index: int

    @property
    def is_cpu(self) -> bool:
        """Whether this is a CPU adapter, as lavapipe and SwiftShader are."""
        return self.adapter_type == "CPU"


_OPENING = threading.RLock()  # drivers are asked what there is, and for it, by a thread at a time
_found: list[Any] = []
_opened: dict[tuple[AdapterInfo, CodePaths, Asked], Gpu] = {}


def _leave_out_opengl() -> None:
    """Make wgpu's instance of this process without OpenGL, or share the one that there is.

    Loading EGL is most of what enumerating costs, and Mesa's warns where it finds no drivers of its
    own. All other defaults are as wgpu has them ("Undefined": its own choice).
    """
    try:
        set_instance_extras(backends=_BACKENDS, dx12_compiler="Undefined")
    except RuntimeError:
        return  # there is one, from another user of wgpu or from before the device was lost


def _enumerate() -> list[Any]:
    """All adapters, enumerated once.

    Any thread may drop them later, which not all drivers bear; OpenGL's, which others may have
    loaded, end the process where two threads enumerate at once.
    """
    enter_driver()
    with _OPENING:
        if not _found:
            check_memory(TO_FIND)
            if not os.environ.get("XDG_RUNTIME_DIR") and os.name == "posix":
                os.environ["XDG_RUNTIME_DIR"] = tempfile.gettempdir()
            _leave_out_opengl()
            try:
                _found.extend(wgpu.gpu.enumerate_adapters_sync())
            except RuntimeError:
                return []
        return [a for a in _found if a.info["backend_type"] != "OpenGL"]


def adapters() -> list[AdapterInfo]:
    """Every usable adapter, best first; empty where there is no driver."""
    # Indices stay those of wgpu's list, whatever the order of preference.
    infos = [
        AdapterInfo(
            name=a.info["device"],
            adapter_type=a.info["adapter_type"],
            backend=a.info["backend_type"],
            driver=a.info["description"],
            vendor=a.info["vendor"],
            index=index,
        )
        for index, a in enumerate(_enumerate())
    ]
    return sorted(infos, key=lambda info: _PREFERENCE.index(info.adapter_type))


def choose(found: Sequence[AdapterInfo], wanted: str = "auto") -> AdapterInfo:
    """The adapter for `wanted`: auto (the best), cpu, gpu, or a part of its name.

    Raises DeviceError with the remedy where there is none.
    """
    if not found:
        raise DeviceError("no graphics driver was found", remedy=NO_DRIVER_REMEDY)
    # A word for a kind of device, or a part of one's name.
    listed = ", ".join(f"{info.name} ({info.adapter_type})" for info in found)
    key = str(wanted).lower()
    if key == "auto":
        return found[0]
    if key in ("cpu", "gpu"):
        matching = [info for info in found if info.is_cpu == (key == "cpu")]
        remedy = NO_DRIVER_REMEDY if key == "cpu" else "Use --adapter auto"
    else:
        matching = [info for info in found if key in info.name.lower()]
        remedy = "Use auto, cpu, gpu or a part of a name"
    if not matching:
        raise DeviceError(f"no adapter matches '{wanted}'; there is {listed}", remedy=remedy)
    return matching[0]


def chosen_reason(found: Sequence[AdapterInfo], chosen: AdapterInfo, wanted: str = "auto") -> str:
    """Why `chosen` was chosen, in words."""
    # By name, alone, or by its kind.
    if wanted.lower() not in ("auto", ""):
        return f"asked for by '{wanted}'"
    if len(found) == 1:
        return "the only adapter"
    others = {info.adapter_type for info in found if info is not chosen}
    return f"{chosen.adapter_type} comes before {', '.join(sorted(others))}"


class Gpu(Scope):
    """An open device with its queue, and a scope of what is made on it.

    All scopes of a device share everything but what they own. Its code paths are decided here,
    once. Raises DeviceError where it cannot be opened.
    """

    def __init__(self, info: AdapterInfo, paths: CodePaths, asked: Asked = "auto") -> None:
        super().__init__()
        adapter = _enumerate()[info.index]

        # A driver that runs out of memory may end the process: there must be some first.
        check_memory(TO_OPEN)
        self.info, self.paths, self.asked = info, paths, asked
        self.features = asked_features(asked, adapter.features)
        limits = asked_limits(asked, paths, adapter.limits)
        try:
            self.device: Any = adapter.request_device_sync(
                label="airlight", required_features=self.features, required_limits=limits
            )
        except (RuntimeError, wgpu.GPUError) as error:
            reason = " ".join(str(error).split())
            raise DeviceError(
                f"{info.name} could not be opened: {reason}", remedy=OPEN_REMEDY
            ) from None
        self.queue: Any = self.device.queue
        self.limits: dict[str, int] = dict(self.device.limits)
        # What the device has, and which path reads parameters.
        can_store = has_uniforms_in_storage(self.limits)
        self.has_uniforms_in_storage = paths.stored_uniforms and can_store
        """Whether shaders read parameters from storage buffers, see `slots.on_cpu_adapter`."""
        self.pipelines = Pipelines()
        self.memory = Memory()
        self.uploads = Uploads(self)
        self.facts: dict[str, bool] = {}
        """What was tried out on the device, once for all its scopes."""
        # For `wait`: a copy of a few bytes that ends after all work before it.
        self._fences: list[Any] = []  # that nobody waits for
        self._fence_source = self.device.create_buffer(
            label="fence source", size=4, usage=wgpu.BufferUsage.COPY_SRC
        )

    @property
    def is_cpu(self) -> bool:
        """Whether this is a CPU adapter. Code paths ask `paths` instead."""
        return self.info.is_cpu

    def scope(self) -> Gpu:
        """The same device with a scope of its own within this one, released no later than it."""
        # A copy of the device's handle with an empty scope, which this one owns.
        inner = copy.copy(self)
        Scope.__init__(inner)
        self.own(inner)
        return inner

    @property
    def allocated_bytes(self) -> int:
        """Bytes that all scopes of the device hold."""
        return self.memory.allocated_bytes

    @property
    def peak_bytes(self) -> int:
        """The most that they held since a Renderer was last made."""
        return self.memory.peak_bytes

    def guarded(self) -> Guarded:
        """A context in which lost devices, memory that ran out and forks are DeviceErrors."""
        return Guarded(self)

    def check_alive(self) -> None:
        """Raise DeviceError where the device was lost."""
        enter_driver()
        if not is_alive(self):
            raise lost(self)

    def wait(self) -> None:
        """Return once everything submitted so far is done; each thread waits by a fence of its own.

        Raises DeviceError.
        """
        with self.guarded():
            # A fence that no thread waits for, or a new one.
            try:
                fence = self._fences.pop()
            except IndexError:
                fence = self._fence()
            # A mapping waits only for the last submit that touched the buffer: it has to be ours.
            encoder = self.device.create_command_encoder(label="fence")
            encoder.copy_buffer_to_buffer(self._fence_source, 0, fence, 0, 4)
            self.queue.submit([encoder.finish()])
            fence.map_sync("READ")
            fence.unmap()
            self._fences.append(fence)  # not where that was broken off: it is being mapped still

    def _fence(self) -> Any:
        usage = wgpu.BufferUsage.COPY_DST | wgpu.BufferUsage.MAP_READ
        return self.device.create_buffer(label="fence", size=4, usage=usage)

    def require(self, limit: str, value: int, what: str, remedy: str = "Make it smaller") -> None:
        """Raise DeviceError where `what` needs more than the device's `limit`."""
        if value > self.limits[limit]:
            raise DeviceError(
                f"{what} needs {limit} = {value}, {self.info.name} has {self.limits[limit]}",
                remedy=remedy,
            )


def open_gpu(wanted: str = "auto", paths: str | None = None, asked: str | None = None) -> Gpu:
    """The device for `wanted` (see `choose`), which takes `paths`: auto, gpu or cpu.

    `asked`: auto, or default for WebGPU's default limits and no optional feature. AIRLIGHT_PATHS
    and AIRLIGHT_LIMITS where they are None. Opened once per process, adapter, paths and limits, and
    again where the device was lost. Any thread may ask. Raises DeviceError, also in a process that
    was forked from one that had used the driver, and SettingsError for words that there are not.
    """
    enter_driver()
    with _OPENING:
        # Lost devices are forgotten, and adapters enumerated again.
        for dead in [key for key, gpu in _opened.items() if not is_alive(gpu)]:
            del _opened[dead]
            _found.clear()  # a driver that was reset may have others
        info = choose(adapters(), wanted or "auto")
        key = (info, chosen_paths(paths, is_cpu=info.is_cpu), chosen_asked(asked))
        if key not in _opened:
            _opened[key] = Gpu(*key)
        return _opened[key]
