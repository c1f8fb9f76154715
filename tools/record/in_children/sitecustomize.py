"""Records what a process runs that a test has started; on ``PYTHONPATH`` while tests are recorded.

Standard library only, and not by name: the folder of the tools is not on the child's path.
"""

import importlib.util
import os
import pathlib
import sys

if os.environ.get("DISTAL_RECORD_TEST"):
    _path = pathlib.Path(__file__).parents[1] / "monitor.py"
    _spec = importlib.util.spec_from_file_location("_distal_monitor", _path)
    _monitor = importlib.util.module_from_spec(_spec)
    sys.modules["_distal_monitor"] = _monitor
    _spec.loader.exec_module(_monitor)
    _monitor.start_in_child()
