"""Many sets of values: pictures, a sheet of them, a table of figures and measures."""

from __future__ import annotations

from distal.lang.option_methods import sweep
from distal.sweeps.drawing import parameter_sets
from distal.sweeps.sweeping import FinishedSweep
from distal.sweeps.table import SweepRow

__all__ = ["FinishedSweep", "SweepRow", "parameter_sets", "sweep"]
