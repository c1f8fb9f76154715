"""``distal render --mode path``: its options, previews, and going on after an interruption."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from typer.testing import CliRunner

from distal.cli import preview
from distal.cli.application import main
from distal.images import png

SCENE = """
from distal import Plane, PointLight, Scene, Sphere

lamp = PointLight((2, 3, 4), intensity=9.0, radius=1.0)
scene = Scene(Sphere(0.5).translate(y=0.5) | Plane(), lights=lamp)
"""
