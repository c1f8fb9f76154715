"""A faster ``__init__`` for frozen dataclasses of which a compilation makes many thousands.

Input: a frozen dataclass with slots. Output: the class; its ``__init__`` takes the same arguments.
A frozen dataclass sets each field by ``object.__setattr__``, which looks up the slot by its name;
here the slots are set directly, in half of the time.
"""

from __future__ import annotations

from dataclasses import MISSING, fields
from typing import Any, TypeVar, cast

C = TypeVar("C")


def quick_init(cls: type[C]) -> type[C]:
    """Give a frozen dataclass with slots, without ``__post_init__``, a faster ``__init__``."""
    assert not hasattr(cls, "__post_init__")
    known: dict[str, Any] = {}
    by_position, by_name, lines = ["self"], ["*"], []
    for field in fields(cast(Any, cls)):
        assert field.init and field.default_factory is MISSING, field.name
        name = field.name
        known[f"set_{name}"] = vars(cls)[name].__set__
        known[f"default_{name}"] = field.default
        default = "" if field.default is MISSING else f"=default_{name}"
        (by_name if field.kw_only else by_position).append(name + default)
        lines.append(f"    set_{name}(self, {name})")
    listed = ", ".join(by_position + (by_name if len(by_name) > 1 else []))
    exec("\n".join([f"def __init__({listed}):", *lines]), known)
    made = known["__init__"]
    made.__qualname__ = f"{cls.__qualname__}.__init__"
    made.__annotations__ = cls.__init__.__annotations__
    cls.__init__ = made  # type: ignore[method-assign]
    return cls
