"""Many sets of values: pictures, a sheet of them, a table of figures and measures."""

from __future__ import annotations

from distal.sweeps.drawing import parameter_sets
from distal.sweeps.sweep_function import sweep
from distal.sweeps.sweeping import FinishedSweep
from distal.sweeps.table import SweepRow

__all__ = ["FinishedSweep", "SweepRow", "parameter_sets", "sweep"]
