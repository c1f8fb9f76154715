"""``python -m distal.cli``: the command where no script is installed."""

from __future__ import annotations

from distal.cli import main

main()
