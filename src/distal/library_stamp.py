"""Which library this is: a stamp that pickles carry, so that another version refuses them.

Input: the source files of the packages that scenes refer to by name. Output: a short text. Two
versions of distal may draw one scene differently, and nobody would see it.
"""

from __future__ import annotations

from functools import cache
from hashlib import blake2b
from pathlib import Path
from pickle import UnpicklingError
from typing import Final

from distal.version import __version__

_PACKAGES: Final = ("fields", "frontend", "ir", "lang", "render", "scene")


@cache
def library_stamp() -> str:
    """Return a text that differs where the library does."""
    root, digest = Path(__file__).parent, blake2b(digest_size=8)
    for file in (file for name in _PACKAGES for file in sorted((root / name).rglob("*.py"))):
        digest.update(file.read_bytes().replace(b"\r\n", b"\n"))
    return f"{__version__} ({digest.hexdigest()})"


def check_stamp(stamp: str) -> None:
    """Refuse a pickle that another library made.

    Raises:
        UnpicklingError: Its stamp is another one.
    """
    if stamp != library_stamp():
        raise UnpicklingError(
            f"this was pickled by distal {stamp}, and here is distal {library_stamp()}; "
            "use the same version of distal in all processes"
        )
