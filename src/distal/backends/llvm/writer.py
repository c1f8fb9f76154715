"""Write the text of one LLVM function, line by line.

Input: instructions as text. Output: a function body. Makes unique names, tracks the current block,
and reserves a line for phis whose operands are known later. Does not depend on lanes.

Text is used instead of a library's objects: it is written and parsed in a few milliseconds, and
``distal compile --target llvm`` prints it even if LLVM is not installed.
"""

from __future__ import annotations


class LlvmWriter:
    """The lines of a function that is being written.

    Attributes:
        lines: The lines so far.
        block: The label of the current block.
    """

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.block = "entry"
        self._head = 0
        self._count = 0
        self._labels = 0
        self._allocations: list[str] = []

    def fresh(self) -> str:
        """Return a new value name."""
        self._count += 1
        return f"%v{self._count}"

    def label(self, purpose: str) -> str:
        """Return a new label, for a block that begins later."""
        self._labels += 1
        return f"{purpose}{self._labels}"

    def value(self, instruction: str) -> str:
        """Write an instruction, and return the name of its result."""
        self._count += 1
        name = f"%v{self._count}"
        self.lines.append(f"  {name} = {instruction}")
        return name

    def line(self, instruction: str) -> None:
        """Write an instruction without a result."""
        self.lines.append("  " + instruction)

    def begin(self, label: str) -> None:
        """Begin a block; the previous block must have ended with a branch."""
        self.lines.append(f"{label}:")
        self.lines.append("")  # filled with phis
        self._head = len(self.lines) - 1
        self.block = label

    def jump(self, label: str) -> None:
        """End the block with a jump."""
        self.lines.append(f"  br label %{label}")

    def branch(self, condition: str, yes: str, no: str) -> None:
        """End the block with a conditional branch.

        Args:
            condition: A scalar i1.
            yes: The label of the next block if the condition is true.
            no: The label of the next block if it is false.
        """
        self.lines.append(f"  br i1 {condition}, label %{yes}, label %{no}")

    def reserve(self) -> int:
        """Return the position where a phi of this block can be written later."""
        return self._head

    def fill(self, position: int, text: str) -> None:
        """Write a phi at a position from ``reserve``."""
        known = self.lines[position]
        self.lines[position] = f"{known}\n  {text}" if known else f"  {text}"

    def allocate(self, type: str, align: int) -> str:
        """Allocate stack memory at the start of the function; return its pointer."""
        name = self.fresh()
        self._allocations.append(f"  {name} = alloca {type}, align {align}")
        return name

    def phi(self, type: str, *incoming: tuple[str, str]) -> str:
        """Write a phi; ``incoming`` are (name, predecessor block)."""
        edges = ", ".join(f"[ {name}, %{block} ]" for name, block in incoming)
        return self.value(f"phi {type} {edges}")

    def text(self) -> str:
        """Return the body."""
        return "\n".join(("entry:", *self._allocations, *filter(None, self.lines)))
