"""A program's inputs in a GPU's memory: uniforms as bytes, textures and buffers uploaded once.

Input: the interface of a WGSL text, and values by name. Output: bytes, and bindings. Does not
depend on pipelines.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.devices.adapters import Gpu, wgpu_module
from distal.devices.base import DeviceError
from distal.devices.resources import load
from distal.ir.types import Buffer, Texture, Type

_VIEWS: Final = {"Texture2D": "2d", "TextureCube": "cube", "Texture3D": "3d"}
_WORDS: Final = {"f": np.float32, "v": np.float32, "m": np.float32, "i": np.int32}


class UniformBytes:
    """The layout of the uniforms in their buffer.

    A scene may have a thousand uniforms, which are written for each frame. So all values are
    collected first and converted together, once for each kind of word.
    """

    def __init__(self, interface: Mapping[str, Any]) -> None:
        rows = interface["uniforms"]
        self._size = interface["uniform_buffer"]["size"]
        self._rows = [(row["name"], row["default"], row["type"]) for row in rows]
        places = [_places(row) for row in rows]
        self._at = np.array([place for row in places for place in row], np.intp)
        kinds = [
            _WORDS.get(row["type"][0], np.uint32)
            for row, words in zip(rows, places, strict=True)
            for _ in words
        ]
        self._kinds = [
            (kind, np.array([i for i, k in enumerate(kinds) if k is kind], np.intp))
            for kind in (np.float32, np.int32, np.uint32)
            if kind in kinds
        ]
        tile = interface.get("tile")
        self._tile = None if tile is None else tile["offset"] // 4

    def packed(
        self, values: Mapping[str, Any], tile: Sequence[int] = (0, 0, 0, 0)
    ) -> NDArray[np.uint32]:
        """Return the words of the buffer.

        Args:
            values: Values by name; missing ones take their defaults.
            tile: The part of a picture to compute: x, y, width, height in pixels.
        """
        flat: list[Any] = []
        for name, default, type in self._rows:
            value = values.get(name, default)
            if isinstance(value, float | int):
                flat.append(value)
            else:
                array = np.asarray(value)
                # Matrices are given by rows and stored by columns.
                flat.extend((array.T if type.startswith("mat") else array).ravel().tolist())
        numbers = np.array(flat, np.float64)  # 64 bits hold every int and uint exactly
        words = np.zeros(self._size // 4, np.uint32)
        for kind, where in self._kinds:
            with np.errstate(over="ignore"):
                whole = numbers[where] if kind is np.float32 else numbers[where].astype(np.int64)
                words[self._at[where]] = whole.astype(kind).view(np.uint32)
        if self._tile is not None:
            words[self._tile : self._tile + 4] = tile
        return words


def _places(row: Mapping[str, Any]) -> list[int]:
    """Return the index of the word of each component of a uniform."""
    first, type = row["offset"] // 4, row["type"]
    if type.startswith("mat"):
        size = int(type[3])
        return [first + (2 if size == 2 else 4) * c + r for c in range(size) for r in range(size)]
    return [first + i for i in range(int(type[-1]) if type[-1].isdigit() else 1)]


class Resources:
    """Textures and buffers in a GPU's memory.

    They are uploaded again only if their source has changed: another object, other content of an
    array, or a modified file.

    Attributes:
        uploads: The number of uploads so far.
    """

    def __init__(self, gpu: Gpu, interface: Mapping[str, Any], types: Mapping[str, Type]) -> None:
        self._gpu = gpu
        self._types = types
        self._textures = interface["textures"]
        self._buffers = interface["buffers"]
        # Constant tables of the program, which nobody can change.
        self._tables = {e["name"]: _values(e) for e in interface["buffers"] if "values" in e}
        self._known: dict[str, tuple[Any, Any]] = {}
        self.uploads = 0

    def bindings(self, device: Any, sources: Mapping[str, Any]) -> tuple[dict[int, Any], bool]:
        """Return the object of each binding, and whether any of them is new."""
        found: dict[int, Any] = {}
        is_new = False
        for entry in self._textures:
            view, changed = self._kept(device, entry, sources[entry["name"]])
            found[entry["binding"]], found[entry["sampler_binding"]] = view
            is_new |= changed
        for entry in self._buffers:
            source = self._tables.get(entry["name"])
            if source is None:
                source = sources[entry["name"]]
            found[entry["binding"]], changed = self._kept(device, entry, source)
            is_new |= changed
        return found, is_new

    def _kept(self, device: Any, entry: Mapping[str, Any], source: Any) -> tuple[Any, bool]:
        name = entry["name"]
        known = self._known.get(name)
        if known is not None and _is_same(known[0], source):
            return known[1], False
        state = _state(source)
        array = source if isinstance(source, np.ndarray) else self._loaded(name, source)
        if state is None:  # nested lists: only their array can be compared
            if known is not None and _is_same(known[0], array):
                return known[1], False
            state = array
        if "element" in entry:
            thing = self._buffer(device, entry, array)
        else:
            thing = self._texture(device, entry, array), _sampler(device, entry)
        self._known[name] = state, thing
        self.uploads += 1
        return thing, True

    def _loaded(self, name: str, source: Any) -> NDArray[Any]:
        type = self._types[name]
        assert isinstance(type, Texture | Buffer)
        return load(source, type)

    def _texture(self, device: Any, entry: Mapping[str, Any], texels: NDArray[Any]) -> Any:
        wgpu = wgpu_module()
        shape = _VIEWS[entry["type"]]
        layers = 1 if texels.ndim == 3 else texels.shape[0]
        height, width = texels.shape[-3:-1]
        most = self._gpu.limit(f"max-texture-dimension-{'3d' if shape == '3d' else '2d'}")
        if max(width, height, layers if shape == "3d" else 1) > most:
            name, label = self._gpu.adapter.name, entry["name"]
            raise DeviceError(f"{name} has textures of up to {most} texels a side; '{label}' is"
                              " larger: --device cpu")  # fmt: skip
        # Half floats if the GPU cannot filter 32-bit floats: a relative error below 1/2000.
        kind = np.float32 if self._gpu.filters_floats else np.float16
        data = np.ascontiguousarray(texels, kind)
        texture = device.create_texture(
            size=(width, height, layers),
            dimension="3d" if shape == "3d" else "2d",
            format="rgba32float" if kind is np.float32 else "rgba16float",
            usage=wgpu.TextureUsage.TEXTURE_BINDING | wgpu.TextureUsage.COPY_DST,
        )
        layout = {"bytes_per_row": width * 4 * data.itemsize, "rows_per_image": height}
        device.queue.write_texture({"texture": texture}, data, layout, (width, height, layers))
        return texture.create_view(dimension=shape)

    def _buffer(self, device: Any, entry: Mapping[str, Any], data: NDArray[Any]) -> Any:
        wgpu = wgpu_module()
        values = np.asarray(data).astype(_WORDS.get(entry["element"][0], np.uint32))
        if entry["element"].startswith("mat"):
            values = np.swapaxes(values.reshape(len(values), *[int(entry["element"][3])] * 2), 1, 2)
        if values.ndim > 1 and values.shape[-1] == 3:
            room = [(0, 0)] * (values.ndim - 1) + [(0, 1)]
            values = np.pad(values, room)  # a column of three occupies the space of four
        bytes_ = np.ascontiguousarray(values)
        most = self._gpu.limit("max-storage-buffer-binding-size")
        if bytes_.nbytes > most:
            name, label = self._gpu.adapter.name, entry["name"]
            raise DeviceError(f"{name} has buffers of up to {most} bytes; '{label}' is larger:"
                              " --device cpu")  # fmt: skip
        return device.create_buffer_with_data(data=bytes_, usage=wgpu.BufferUsage.STORAGE)


def _values(entry: Mapping[str, Any]) -> NDArray[Any]:
    """Return the elements of a buffer that holds a constant table."""
    return np.array(entry["values"], _WORDS.get(entry["element"][0], np.uint32))


def view_dimension(entry: Mapping[str, Any]) -> str:
    """Return the view dimension of a texture's binding: "2d", "cube" or "3d"."""
    return _VIEWS[entry["type"]]


def _sampler(device: Any, entry: Mapping[str, Any]) -> Any:
    mode = "repeat" if entry["wrap"] == "repeat" else "clamp-to-edge"
    return device.create_sampler(
        mag_filter="linear",
        min_filter="linear",
        address_mode_u=mode,
        address_mode_v=mode,
        address_mode_w=mode,
    )


def _state(source: Any) -> Any:
    """Return the identity of a source without loading it: file states, or a copy of its array.

    Arrays are compared, not hashed: comparing reads 5 GB/s, hashing 1 GB/s, and it is exact.
    """
    data = source if isinstance(source, np.ndarray) else source.data
    if isinstance(data, np.ndarray):
        return data.copy()
    paths = data if isinstance(data, list | tuple) else [data]
    if paths and all(isinstance(path, str | Path) for path in paths):
        try:
            infos = [Path(path).stat() for path in paths]
        except OSError:
            return None
        return [(str(path), i.st_mtime_ns, i.st_size) for path, i in zip(paths, infos, strict=True)]
    return None


def _is_same(known: Any, source: Any) -> bool:
    """Return whether a source is still in the recorded state."""
    data = source if isinstance(source, np.ndarray) else source.data
    if isinstance(known, np.ndarray):
        return (
            isinstance(data, np.ndarray)
            and data.dtype == known.dtype
            and np.array_equal(data, known)
        )
    return known is not None and not isinstance(data, np.ndarray) and known == _state(source)
