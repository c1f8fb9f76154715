"""``python -m distal.cli``: runs the command where the script is not installed."""

from __future__ import annotations

from distal.cli import main

main()
