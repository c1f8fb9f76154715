"""Where random numbers start: another place each day, so that in time the tests try everything.

A failure names the seed; ``DISTAL_FIELD_SEED`` sets it, to see the failure again.
"""

from __future__ import annotations

import os
import time
import zlib
from typing import Final

SECONDS_OF_A_DAY: Final = 86400
SEED: Final = int(os.environ.get("DISTAL_FIELD_SEED") or time.time() // SECONDS_OF_A_DAY)


def seed_of(name: str) -> int:
    """Another for each name, and another each day."""
    return zlib.crc32(f"{SEED} {name}".encode())


def seeded(findings: list[str]) -> str:
    """Findings as text, with the seed that shows them again."""
    return "\n".join([*findings, f"(DISTAL_FIELD_SEED={SEED})"])
