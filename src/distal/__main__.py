"""``python -m distal``: runs the command where the script is not on the search path."""

from __future__ import annotations

from distal.cli import main

main()
