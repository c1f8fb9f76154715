"""Built-ins that are not names of the language: for the prelude's scene code only."""

from __future__ import annotations

from distal.ir.intrinsics import INTRINSICS
from distal.lang.names import LangFunction

globals().update({row.name: LangFunction(row) for row in INTRINSICS.values() if row.hidden})
