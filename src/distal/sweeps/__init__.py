"""All combinations of some values of parameters: pictures, a sheet of them, a table of figures."""

from __future__ import annotations

from distal.sweeps.sweeping import FinishedSweep, sweep

__all__ = ["FinishedSweep", "sweep"]
