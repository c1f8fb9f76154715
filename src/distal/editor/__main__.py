"""``python -m distal.editor FOLDER``: the studio's worker as a process.

Input: as for ``distal.editor.worker``. Memory is not tidied while Python starts: that takes a fifth
of the time until the first answer, and nothing is garbage yet.
"""

from __future__ import annotations

import gc

gc.disable()

from distal.editor.worker import main  # noqa: E402 (after the line above)

if __name__ == "__main__":
    main()
