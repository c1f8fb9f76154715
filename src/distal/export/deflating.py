"""Compress what a page carries: deflate without a header, as base64; browsers unpack it."""

from __future__ import annotations

import base64
import zlib


def deflated(data: bytes) -> str:
    """Return bytes compressed, as a text."""
    press = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS, 9)
    return base64.b64encode(press.compress(data) + press.flush()).decode("ascii")
