"""Where random numbers start: ``make test`` always draws the same, a sweep others each day.

A change is judged by the same numbers today and tomorrow. A failure names the seed;
``DISTAL_FIELD_SEED`` sets it, to see the failure again.
"""

from __future__ import annotations

import os
import time
import zlib
from typing import Final

SECONDS_OF_A_DAY: Final = 86400
OF_THE_DAY: Final = "day"
FIRST: Final = 20780


def _seed() -> int:
    given = os.environ.get("DISTAL_FIELD_SEED", "")
    if given == OF_THE_DAY:
        return int(time.time()) // SECONDS_OF_A_DAY
    return int(given or FIRST)


SEED: Final = _seed()


def seed_of(name: str) -> int:
    """Another for each name."""
    return zlib.crc32(f"{SEED} {name}".encode())


def seeded(findings: list[str]) -> str:
    """Findings as text, with the seed that shows them again."""
    return "\n".join([*findings, f"(DISTAL_FIELD_SEED={SEED})"])
