"""Write texts into animated pictures, which FFmpeg's writers do not do.

Input: a finished GIF, APNG or WebP, and texts. Output: the same file with the texts in a comment
extension, iTXt chunks or an EXIF chunk. Pixels are not changed.
"""

from __future__ import annotations

import json
import os
import shutil
import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO, Final

from PIL import Image

from distal.video.formats import VideoFormat

_EXIF_DESCRIPTION: Final = 0x010E
_EXIF_SOFTWARE: Final = 0x0131
_WEBP_HAS_EXIF: Final = 0x08
_WEBP_NO_BLEND: Final = 0x02


def with_texts(path: Path, format: VideoFormat, texts: Mapping[str, str]) -> None:
    """Write texts into a file.

    Args:
        path: The file.
        format: Its format: gif, apng or webp.
        texts: The texts by key.
    """
    if format.name == "webp":
        with open(path, "r+b") as file:
            _webp(file, texts)
        return
    temporary = path.with_name(f"{path.name}.texts")
    with open(path, "rb") as source, open(temporary, "wb") as target:
        {"gif": _gif, "apng": _png}[format.name](source, target, texts)
        shutil.copyfileobj(source, target, 2**20)
    os.replace(temporary, path)


def _gif(source: BinaryIO, target: BinaryIO, texts: Mapping[str, str]) -> None:
    """Insert a comment extension after the palette (GIF89a, section 24): blocks of <= 255 bytes."""
    header = source.read(13)
    flags = header[10]
    palette = source.read(3 << ((flags & 7) + 1)) if flags & 0x80 else b""
    text = _together(texts).encode("utf-8")
    blocks = (text[i : i + 255] for i in range(0, len(text), 255))
    comment = b"".join(bytes([len(block)]) + block for block in blocks)
    target.write(header + palette + b"\x21\xfe" + comment + b"\x00")


def _png(source: BinaryIO, target: BinaryIO, texts: Mapping[str, str]) -> None:
    """Insert sRGB and iTXt chunks after IHDR (PNG specification, 11.3.2.5 and 11.3.3.4)."""
    target.write(source.read(8 + 25))  # the signature and IHDR
    target.write(_chunk(b"sRGB", b"\0"))  # perceptual, the intent for pictures
    for key, text in texts.items():
        # No compression, no language, no translated keyword.
        body = key.encode("latin-1", "replace") + b"\0\0\0\0\0" + text.encode("utf-8")
        target.write(_chunk(b"iTXt", body))


def _chunk(name: bytes, body: bytes) -> bytes:
    check = zlib.crc32(name + body)
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", check)


def _webp(file: BinaryIO, texts: Mapping[str, str]) -> None:
    """Append an EXIF chunk (WebP container specification, "Extended File Format")."""
    head = file.read(30)
    if head[12:16] != b"VP8X":  # a single frame: the simple format cannot store it
        return
    _replace_frames(file)
    exif = Image.Exif()
    exif[_EXIF_DESCRIPTION] = _together(texts)
    exif[_EXIF_SOFTWARE] = texts.get("software", "")
    body = exif.tobytes()
    chunk = b"EXIF" + struct.pack("<I", len(body)) + body + b"\0" * (len(body) % 2)
    (size,) = struct.unpack_from("<I", head, 4)
    file.seek(0, os.SEEK_END)
    file.write(chunk)
    file.seek(4)
    file.write(struct.pack("<I", size + len(chunk)))
    file.seek(20)
    file.write(bytes([head[20] | _WEBP_HAS_EXIF]))


def _replace_frames(file: BinaryIO) -> None:
    """Mark frames as not blended; otherwise viewers would blend them over the previous frame."""
    at = 12
    while len(head := _read_at(file, at, 8)) == 8:
        (size,) = struct.unpack_from("<I", head, 4)
        if head[:4] == b"ANMF":
            flags = _read_at(file, at + 23, 1)[0]
            file.seek(at + 23)
            file.write(bytes([flags | _WEBP_NO_BLEND]))
        at += 8 + size + size % 2


def _read_at(file: BinaryIO, at: int, count: int) -> bytes:
    file.seek(at)
    return file.read(count)


def _together(texts: Mapping[str, str]) -> str:
    """Join all texts to one comment, for formats with a single comment."""
    return texts.get("comment") or json.dumps(dict(texts), sort_keys=True)
