"""The ``distal`` command: parses the command line, calls the library, reports errors.

Input: the arguments of the command line. Output: files, text on stdout (data only), messages on
stderr, and an exit code (``distal.cli.exit_codes``). Contains no algorithms. This module imports
next to nothing, so that ctrl-C is handled before anything else is imported.
"""

from __future__ import annotations

from distal.interrupting import end_at_once

# The commands, as --help lists them: first those that new users need.
COMMANDS = (
    *("render", "view", "studio", "new", "video", "sweep", "mesh", "slice", "export", "rerender"),
    *("check", "probe", "measure", "compile", "examples", "doctor"),
)
# The others have a module of their name: one of them is imported without the rest.
SHORT = ("compile", "examples", "doctor")


def main() -> None:
    """Run the command line of this process."""
    end_at_once()
    from distal.cli.running import run

    run()
