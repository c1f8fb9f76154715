"""The object files of a kernel: compile them, store them in the cache and find them again.

Input: LLVM modules, or the text that identifies a kernel. Output: object files of one of LLVM's
levels of code generation, and what is needed to call them.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable, Sequence
from typing import Any

from distal.devices.cache import Cache
from distal.devices.features import CpuLevel
from distal.devices.jit import compile_apart, compile_objects
from distal.devices.kernel_key import kernel_key, object_key


class ObjectFiles:
    """The object files of a kernel, of the levels that LLVM generates code at.

    Attributes:
        texts: The LLVM modules; empty if they are not needed again.
        interface: How the kernel is called.
    """

    def __init__(self, level: CpuLevel, precision: int, identity: str, cache: Cache) -> None:
        self._level, self._precision, self._identity = level, precision, identity
        self._cache = cache
        self._keys: dict[int, list[str]] = {}  # hashing a megabyte of text takes 5 ms
        self.texts: Sequence[str] = ()
        self.interface: dict[str, Any] = {}

    def load(self, llvm_level: int, *, with_texts: bool = False) -> Sequence[bytes]:
        """Return the object files of a stored kernel, and set the attributes; empty: not stored.

        Args:
            llvm_level: LLVM's level that made them.
            with_texts: Whether the modules must be stored too, to compile them at another level.
        """
        data = self._cache.load(self._key(llvm_level))
        if data is None:
            return ()
        interface = json.loads(zlib.decompress(data))
        self.texts, keys = interface.pop("texts"), interface.pop("objects")
        if with_texts and not self.texts:
            return ()
        self.interface = interface
        return self._stored(keys)

    def compiled(self, llvm_level: int) -> Sequence[bytes]:
        """Return the object files of the modules if the cache has all of them; else nothing."""
        return self._stored(self._object_keys(llvm_level))

    def compile(self, llvm_level: int, *, niceness: int = 0) -> Sequence[bytes]:
        """Return the object files of the modules; compile and store those that are missing.

        Args:
            llvm_level: LLVM's level.
            niceness: Above 0, processes that give way to others compile one module at a time.
        """
        keys = self._object_keys(llvm_level)
        objects = {key: found for key in keys if (found := self._cache.load(key)) is not None}
        missing = {k: t for k, t in zip(keys, self.texts, strict=True) if k not in objects}
        made: Iterable[bytes] = ()
        if niceness:
            made = (
                compile_apart(text, self._level, llvm_level, niceness=niceness)
                for text in missing.values()
            )
        elif missing:
            made = compile_objects(list(missing.values()), self._level, llvm_level)
        for key, code in zip(missing, made, strict=True):
            self._cache.store(key, code)
            objects[key] = code
        return [objects[key] for key in keys]

    def store(self, llvm_level: int, *, with_texts: bool = False) -> None:
        """Store the interface and the keys of the object files, which are stored already.

        Args:
            llvm_level: LLVM's level that made them.
            with_texts: Whether to store the modules too, to compile them at another level.
        """
        keys, texts = self._object_keys(llvm_level), self.texts if with_texts else ()
        data = json.dumps({**self.interface, "objects": keys, "texts": texts}).encode()
        self._cache.store(self._key(llvm_level), zlib.compress(data, 1))

    def discard(self, llvm_level: int) -> None:
        """Remove what the cache has for a level."""
        for key in (self._key(llvm_level), *self._object_keys(llvm_level)):
            self._cache.discard(key)

    def _stored(self, keys: Sequence[str]) -> Sequence[bytes]:
        objects = [found for key in keys if (found := self._cache.load(key)) is not None]
        return objects if len(objects) == len(keys) else ()

    def _object_keys(self, llvm_level: int) -> list[str]:
        if llvm_level not in self._keys:
            keys = [object_key(self._level, text, llvm_level) for text in self.texts]
            self._keys[llvm_level] = keys
        return self._keys[llvm_level]

    def _key(self, llvm_level: int) -> str:
        return kernel_key(self._level, self._precision, self._identity, llvm_level=llvm_level)
