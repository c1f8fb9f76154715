"""Fingerprints of programs with their numbers and data: equal if they draw the same picture.

Input: digests, numbers and resources. Output: a text. Does not depend on devices.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from distal.version import __version__


def fingerprint(parts: Any, resources: Mapping[str, Any]) -> str:
    """Return the SHA-256 of digests, numbers and the data of resources, as hexadecimal digits.

    Args:
        parts: What can be written as JSON; the ``repr`` of what cannot is used.
        resources: Textures and buffers by name.
    """
    text = json.dumps([__version__, parts], sort_keys=True, default=repr)
    digest = hashlib.sha256(text.encode())
    for name, source in sorted(resources.items()):
        digest.update(f"\0{name}\0".encode())
        digest.update(_bytes(getattr(source, "data", source)))
    return digest.hexdigest()


def _bytes(data: Any) -> bytes:
    """Return the data of a texture or a buffer; for a file, its content."""
    if isinstance(data, str | Path):
        try:
            return Path(data).read_bytes()
        except OSError:  # rendering reports the error
            return str(data).encode()
    try:
        array = np.asarray(data)
    except ValueError:
        return repr(data).encode()
    if array.dtype == object:
        return repr(data).encode()
    return f"{array.dtype}{array.shape}".encode() + array.tobytes()
