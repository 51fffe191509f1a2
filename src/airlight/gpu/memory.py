"""Textures and buffers: labelled, counted, owned by a scope, with their views made once."""

from __future__ import annotations

from typing import Any

import numpy as np
import wgpu
from numpy.typing import NDArray

from .device import Gpu
from .process import is_forked

_TEXTURE_USAGE = (
    wgpu.TextureUsage.TEXTURE_BINDING | wgpu.TextureUsage.COPY_SRC | wgpu.TextureUsage.COPY_DST
)
_BYTES = {  # of one texel
    "r8unorm": 1,
    "rgba8unorm": 4,
    "rgba8unorm-srgb": 4,
    "bgra8unorm": 4,
    "bgra8unorm-srgb": 4,
    "r16float": 2,
    "rg16float": 4,
    "rgba16float": 8,
    "r32float": 4,
    "rg32float": 8,
    "rgba32float": 16,
    "rgba32uint": 16,
    "depth32float": 4,
    "r32uint": 4,
    "rg32uint": 8,
    "rgba8snorm": 4,
}
_DTYPES = {
    "rgba8unorm": (np.uint8, 4),
    "rgba8unorm-srgb": (np.uint8, 4),
    "r16float": (np.float16, 1),
    "rgba16float": (np.float16, 4),
    "r32float": (np.float32, 1),
    "rg32float": (np.float32, 2),
    "rgba32float": (np.float32, 4),
    "depth32float": (np.float32, 1),
    "r32uint": (np.uint32, 1),
    "rgba32uint": (np.uint32, 4),
    "rg32uint": (np.uint32, 2),
    "rgba8snorm": (np.int8, 4),
    "rg16float": (np.float16, 2),
    "r8unorm": (np.uint8, 1),
}


class _Counted:
    """A resource of the device whose bytes are counted while it exists."""

    gpu: Gpu
    handle: Any = None
    nbytes: int

    def _hold(self, gpu: Gpu) -> None:
        """Count the memory, and let the scope `gpu` own the resource."""
        gpu.memory.count(self.nbytes)
        gpu.own(self)

    def release(self) -> None:
        """Give the memory back before the scope does."""
        handle, self.handle = self.handle, None
        if handle is not None:
            self.gpu.memory.count(-self.nbytes)
            if not is_forked():
                handle.destroy()

    def __del__(self) -> None:
        # Where an error came before a release. What is encoded still may need it: not destroyed.
        if self.handle is not None:
            self.gpu.memory.count(-self.nbytes)


class Texture(_Counted):
    """A texture and its views. `size` is (width, height, depth or layers)."""

    def __init__(
        self,
        gpu: Gpu,
        label: str,
        size: tuple[int, ...],
        format: str,
        *,
        dimension: str = "2d",
        target: bool = False,
        written: bool = False,
        mips: int = 1,
    ) -> None:
        # Larger than the device allows is a message that names the limit, not a validation error.
        width, height, depth = (*size, 1, 1)[:3]
        is_3d = dimension == "3d"
        limit = "max-texture-dimension-3d" if is_3d else "max-texture-dimension-2d"
        gpu.require(limit, max(width, height, depth if is_3d else 1), f"texture '{label}'")
        if not is_3d:
            gpu.require("max-texture-array-layers", depth, f"texture '{label}'")
        usage = _TEXTURE_USAGE
        usage |= wgpu.TextureUsage.RENDER_ATTACHMENT if target else 0
        usage |= wgpu.TextureUsage.STORAGE_BINDING if written else 0
        self.gpu, self.label, self.size, self.format = gpu, label, (width, height, depth), format
        self.mips = mips
        # The texture and the view that slots bind.
        with gpu.guarded():
            made = gpu.device.create_texture(
                label=label,
                size=self.size,
                format=format,
                usage=usage,
                dimension="3d" if is_3d else "2d",
                mip_level_count=mips,
            )
            self.resource: Any = made.create_view(label=label, dimension=dimension)
        # A chain of mip levels adds a third.
        self._layers: dict[int, Any] = {}
        self.nbytes = width * height * depth * _BYTES[format] * (4 if mips > 1 else 3) // 3
        self.handle = made
        self._hold(gpu)

    def layer(self, index: int) -> Any:
        """The view of one array layer, for rendering into it."""
        if index not in self._layers:
            self._layers[index] = self.handle.create_view(
                label=f"{self.label}[{index}]",
                dimension="2d",
                base_array_layer=index,
                array_layer_count=1,
                mip_level_count=1,
            )
        return self._layers[index]

    def write(
        self,
        pixels: NDArray[Any],
        *,
        mip: int = 0,
        layer: int = 0,
        row: int = 0,
        column: int = 0,
    ) -> None:
        """Upload a box of texels from (`column`, `row`, `layer`) on; else a whole mip level."""
        data = np.ascontiguousarray(pixels)
        dtype, channels = _DTYPES[self.format]
        if data.dtype != dtype:
            raise TypeError(f"{self.label}: {self.format} takes {dtype.__name__}, not {data.dtype}")
        depth, height, width = (1, *data.shape)[-4:-1] if channels > 1 else (1, *data.shape)[-3:]
        with self.gpu.guarded():
            self.gpu.queue.write_texture(
                {"texture": self.handle, "mip_level": mip, "origin": (column, row, layer)},
                data,
                {"bytes_per_row": data.itemsize * channels * width, "rows_per_image": height},
                (width, height, depth),
            )

    def read(self, layer: int | None = None) -> NDArray[Any]:
        """The texels: (H, W, C), or (D, H, W, C) for 3D and arrays; C dropped where it is 1."""
        width, height, depth = self.size
        dtype, channels = _DTYPES[self.format]
        first, layers = (0, depth) if layer is None else (layer, 1)
        # What is read at once goes through a buffer, which has a largest size.
        most = self.gpu.limits["max-buffer-size"] // (-(-self._row_bytes // 256) * 256)
        if height * layers <= most:
            texels = self._part((0, first), (height, layers))
        else:
            texels = np.empty((layers, height, width, channels), dtype)
            for z in range(layers):
                for y in range(0, height, most):
                    rows = min(most, height - y)
                    texels[z, y : y + rows] = self._part((y, first + z), (rows, 1))[0]
        texels = texels[0] if layers == 1 else texels
        return texels[..., 0] if channels == 1 else texels

    @property
    def _row_bytes(self) -> int:
        dtype, channels = _DTYPES[self.format]
        return self.size[0] * channels * np.dtype(dtype).itemsize

    def _part(self, origin: tuple[int, int], count: tuple[int, int]) -> NDArray[Any]:
        """Whole rows of whole layers, `count` of each from `origin` on: (layers, rows, W, C)."""
        (y, z), (rows, layers) = origin, count
        dtype, channels = _DTYPES[self.format]
        with self.gpu.guarded():
            raw = self.gpu.queue.read_texture(
                {"texture": self.handle, "mip_level": 0, "origin": (0, y, z)},
                {"bytes_per_row": self._row_bytes, "rows_per_image": rows},
                (self.size[0], rows, layers),
            )
        return np.frombuffer(raw, dtype).reshape(layers, rows, self.size[0], channels)


class Buffer(_Counted):
    """A buffer for storage, vertices, indices or uniforms."""

    def __init__(
        self,
        gpu: Gpu,
        label: str,
        nbytes: int,
        *,
        vertex: bool = False,
        index: bool = False,
        indirect: bool = False,
    ) -> None:
        gpu.require("max-buffer-size", nbytes, f"buffer '{label}'")
        if not (vertex or index):
            gpu.require("max-storage-buffer-binding-size", nbytes, f"buffer '{label}'")
        # Every buffer may be copied and bound; vertices, indices and arguments are told.
        usage = wgpu.BufferUsage.COPY_DST | wgpu.BufferUsage.COPY_SRC | wgpu.BufferUsage.STORAGE
        usage |= wgpu.BufferUsage.VERTEX if vertex else 0
        usage |= wgpu.BufferUsage.INDEX if index else 0
        usage |= wgpu.BufferUsage.INDIRECT if indirect else 0
        self.gpu, self.label = gpu, label
        # Whole words, and no empty binding.
        self.nbytes = max(16, -(-nbytes // 4) * 4)
        with gpu.guarded():
            self.handle = gpu.device.create_buffer(label=label, size=self.nbytes, usage=usage)
        self.resource: Any = {"buffer": self.handle, "offset": 0, "size": self.nbytes}
        self._hold(gpu)

    def write(self, data: NDArray[Any], offset: int = 0) -> None:
        """Upload; happens before anything submitted later, after anything submitted before."""
        sent = np.ascontiguousarray(data).reshape(-1).view(np.uint8)
        with self.gpu.guarded():
            most = self.gpu.paths.uploaded_at_once
            for k in range(0, len(sent), most):
                self.gpu.queue.write_buffer(self.handle, offset + k, sent[k : k + most])
                if len(sent) > most:  # copied while the next part is handed over
                    self.gpu.queue.submit([])

    def read(self, dtype: Any = np.float32) -> NDArray[Any]:
        """The contents, once everything submitted is done."""
        with self.gpu.guarded():
            return np.frombuffer(self.gpu.queue.read_buffer(self.handle), dtype)


class BufferPart(Buffer):
    """A run of a buffer's bytes, bound as a buffer of its own; the whole is another's to release.

    Stages bind few buffers: where one pass reads what several write, it binds the whole.
    """

    ALIGNMENT = 256
    """Bytes: at multiples of it a part may begin on every device."""

    def __init__(self, whole: Buffer, offset: int, nbytes: int) -> None:
        self.gpu, self.label, self.handle = whole.gpu, whole.label, whole.handle
        self._offset, self.nbytes = offset, nbytes
        self.resource = {"buffer": self.handle, "offset": offset, "size": nbytes}

    def write(self, data: NDArray[Any], offset: int = 0) -> None:
        """As `Buffer.write`; `offset` within the part."""
        super().write(data, self._offset + offset)

    def read(self, dtype: Any = np.float32) -> NDArray[Any]:
        """As `Buffer.read`."""
        with self.gpu.guarded():
            raw = self.gpu.queue.read_buffer(self.handle, self._offset, self.nbytes)
        return np.frombuffer(raw, dtype)

    def release(self) -> None:
        """Nothing: it has no memory of its own."""

    def __del__(self) -> None:
        pass


def buffer_of(gpu: Gpu, label: str, data: NDArray[Any], **usage: bool) -> Buffer:
    """A buffer that holds `data`."""
    made = Buffer(gpu, label, data.nbytes, **usage)
    made.write(data)
    return made


class Sampler:
    """How a texture is filtered and what lies beyond its border."""

    def __init__(self, gpu: Gpu, label: str, **settings: Any) -> None:
        self.resource: Any = gpu.device.create_sampler(label=label, **settings)


def linear_sampler(gpu: Gpu, label: str = "linear clamp", wrap: str = "clamp-to-edge") -> Sampler:
    """Trilinear filtering."""
    return Sampler(
        gpu,
        label,
        mag_filter="linear",
        min_filter="linear",
        mipmap_filter="linear",
        address_mode_u=wrap,
        address_mode_v=wrap,
        address_mode_w=wrap,
    )


def nearest_sampler(gpu: Gpu) -> Sampler:
    """The nearest texel."""
    return Sampler(gpu, "nearest")
