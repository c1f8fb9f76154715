"""The text of one LLVM function, line by line.

Input: instructions as text. Output: a function body. Gives fresh names, knows the block being
written, and leaves a line for phis whose operands come later. Knows nothing of lanes.

Text rather than a library's objects: it is written and parsed in a few milliseconds, and printed by
``distal compile --target llvm`` without LLVM being installed.
"""

from __future__ import annotations


class LlvmWriter:
    """Lines of a function under construction."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.block = "entry"
        self._head = 0
        self._count = 0
        self._labels = 0
        self._allocations: list[str] = []

    def fresh(self) -> str:
        """A new value name."""
        self._count += 1
        return f"%v{self._count}"

    def label(self, purpose: str) -> str:
        """A new block name, not yet begun."""
        self._labels += 1
        return f"{purpose}{self._labels}"

    def value(self, instruction: str) -> str:
        """Write an instruction and name its result."""
        self._count += 1
        name = f"%v{self._count}"
        self.lines.append(f"  {name} = {instruction}")
        return name

    def line(self, instruction: str) -> None:
        """Write an instruction without a result."""
        self.lines.append("  " + instruction)

    def begin(self, label: str) -> None:
        """Begin a block; the one before must have ended in a branch."""
        self.lines.append(f"{label}:")
        self.lines.append("")  # filled with phis
        self._head = len(self.lines) - 1
        self.block = label

    def jump(self, label: str) -> None:
        """End the block."""
        self.lines.append(f"  br label %{label}")

    def branch(self, condition: str, yes: str, no: str) -> None:
        """End the block in two ways."""
        self.lines.append(f"  br i1 {condition}, label %{yes}, label %{no}")

    def reserve(self) -> int:
        """Where a phi of this block is to be written later."""
        return self._head

    def fill(self, position: int, text: str) -> None:
        """Write a phi of a block that was begun before."""
        known = self.lines[position]
        self.lines[position] = f"{known}\n  {text}" if known else f"  {text}"

    def allocate(self, type: str, align: int) -> str:
        """Memory that lives as long as the function, made at its top."""
        name = self.fresh()
        self._allocations.append(f"  {name} = alloca {type}, align {align}")
        return name

    def phi(self, type: str, *incoming: tuple[str, str]) -> str:
        """A value chosen by the block control came from."""
        edges = ", ".join(f"[ {name}, %{block} ]" for name, block in incoming)
        return self.value(f"phi {type} {edges}")

    def text(self) -> str:
        """The body."""
        return "\n".join(("entry:", *self._allocations, *filter(None, self.lines)))
