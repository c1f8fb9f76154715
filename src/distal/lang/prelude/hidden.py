"""The hidden rows of the table under the names that prelude code calls them by.

They are what a target computes by itself with a narrower meaning than the language promises; the
prelude functions around them make up the difference. Authors never see them.
"""

from __future__ import annotations

from typing import Final

from distal.ir.intrinsics import INTRINSICS
from distal.lang.names import LangFunction

raw_atan2: Final = LangFunction(INTRINSICS["raw_atan2"])
raw_power: Final = LangFunction(INTRINSICS["raw_power"])
saturated_int: Final = LangFunction(INTRINSICS["saturated_int"])
saturated_uint: Final = LangFunction(INTRINSICS["saturated_uint"])
truncated_quotient: Final = LangFunction(INTRINSICS["truncated_quotient"])
