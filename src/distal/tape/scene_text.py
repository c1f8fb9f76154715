"""Make scene functions from texts that this package writes.

Input: the text of one function. Output: a ``Func``, as if its text stood in a file.
"""

from __future__ import annotations

from collections.abc import Mapping

from distal import lang
from distal.lang.functions import Func, Overload
from distal.lang.source import Source


def overload_of(text: str, name: str, callees: Mapping[str, Func] | None = None) -> Overload:
    """Return the function that a text defines, as an overload of a ``Func``.

    Args:
        text: The text.
        name: The name of the function.
        callees: The functions that it calls, besides those of the language.
    """
    file = f"<{name}>"
    known = {**vars(lang), **(callees or {}), "__name__": __name__}
    exec(compile(text, file, "exec", dont_inherit=True), known)
    return Overload(known[name], Source(file, text.splitlines(keepends=True), 1), {})
