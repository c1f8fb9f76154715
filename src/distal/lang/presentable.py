"""The methods of every picture besides rendering: show, export, write as a video, show in a cell.

Those with options are generated. ``distal.notebook``, ``distal.export`` and ``distal.video`` do the
work; they are imported when first needed.
"""

from __future__ import annotations

from typing import Any

from distal.lang.option_methods import PresentableMethods
from distal.lang.runtime_access import widget
from distal.packages import explained


class Presentable(PresentableMethods):
    """Base class of objects that can be viewed: scenes, shapes, images."""

    __slots__ = ()

    def _repr_mimebundle_(self, **_: object) -> Any:
        """Return what a notebook's cell shows that ends with this object: its live picture.

        Without the extra ``notebook`` it is a still one.
        """
        try:
            bundle = widget.bundle_of
        except Exception as error:
            found = explained(error) or error
            still = getattr(self, "render")()._repr_png_()  # noqa: B009 (of every subclass)
            return {"image/png": still, "text/plain": f"{self!r}\n{found}"}
        return bundle(self)
