"""Programs that another process has lowered, in place of the objects of an author.

Input: modules, and what an executor must know of a picture besides. Output: an object that the
executor renders as it renders a scene. Does not depend on how it came here.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NoReturn

from distal.lang.composed import Composed
from distal.runtime.lowered import Lowered


class Received(Composed):
    """A lowered program; its source code is not known here.

    Args:
        name: Its name in messages and metadata.
        lowered: Its IR.
        display: The program that encodes its pixels, or None.
        adaptive: As ``Composed.adaptive``.
        refined: As ``Composed.refined``.
        photons: The two programs of its photons, or None.
        glow: As ``Composed.glow``.
    """

    def __init__(
        self,
        name: str,
        lowered: Lowered,
        display: Received | None = None,
        *,
        adaptive: bool = False,
        refined: bool = False,
        photons: Sequence[Received] | None = None,
        glow: float = 0.0,
    ) -> None:
        entry = lowered.module.function(lowered.module.entry)
        self.name, self.lowered, self.display = name, lowered, display
        self.signature = tuple((p.name, p.type) for p in entry.params)
        self.result = entry.result
        self.adaptive, self.refined, self.glow = adaptive, refined, glow
        self.photons = None if photons is None else (photons[0], photons[1])

    def compose(self, assembly: Any) -> NoReturn:
        """Refuse: it is a whole program."""
        raise AssertionError("a program that was received is no part of another one")
