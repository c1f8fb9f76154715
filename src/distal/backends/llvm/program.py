"""Translate one module to LLVM text.

Input: a module after the passes, and the shape of the machine's vectors. Output: the text of an
LLVM module with the kernels that are needed: pixels of a picture, the per-frame part, a batch of
points. A function that is not inlined becomes an LLVM function, once for each set of varying
arguments; a long one computes one vector of each value instead of all (decision 29).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from distal.backends.llvm.arithmetic import LaneArithmetic
from distal.backends.llvm.chains import Chains
from distal.backends.llvm.costs import LaneCosts
from distal.backends.llvm.expressions import LaneExpressions
from distal.backends.llvm.lanes import Lanes, Leaf, Leaves, leaf_count, leaf_kinds
from distal.backends.llvm.layout import JOB_OFFSET, KernelLayout
from distal.backends.llvm.modules import LlvmFunction, LlvmProgram
from distal.backends.llvm.statements import Statements
from distal.backends.llvm.storage import Mask
from distal.backends.llvm.uniformity import Uniformity
from distal.backends.llvm.writer import LlvmWriter
from distal.diagnostics import CompileError
from distal.error_codes import ErrorCode
from distal.ir.contents import calls_in, contents, size_of
from distal.ir.nodes import Expr, Function, Module
from distal.ir.types import Kind
from distal.ir.walk import roots_in

# The register width of each level, so that LLVM neither splits nor avoids full vectors.
_REGISTER_BITS = {"avx512": 512, "avx2": 256, "sse4.2": 128, "neon": 128}

# The largest cost of a function that is inlined at each call, for each vector of a value: vector
# registers are not preserved by calls, so calling a small function costs more than its body.
INLINE_COST = 120
# The largest cost of a function that is inlined at its only call. Inlining without a limit put a
# whole scene into one function, and LLVM's time grows faster than a function's length.
ONCE_COST = 600
# A function of at least this cost, without loops, is called for each vector of a value separately
# if it has enough independent instructions, because then it is only a fraction as long.
CHUNK_COST = 400
# The least cost for each instruction of the longest chain: as independent instructions as hide the
# latency of each other. Smooth unions have 7, hard unions 13 or more; with 7, a frame took 1.2
# times as long.
PARALLEL = 10
# A function of this cost is called for each vector in any case, unless it has a loop of more
# rounds. The function of all parts of a table has the short loops of some kinds.
LARGE_COST = 3000
FEW_ROUNDS = 64
# Arrays are on a thread's stack, with a value for each lane; ``devices.threads`` enlarges it.
ARRAY_BYTES = 8 * 2**20
_SMALL_ARRAY_BYTES = 2**18


class LaneProgram:
    """The state that the functions of one LLVM module share.

    Attributes:
        module: The IR module.
        lanes: The vector shape.
        layout: The slots of the inputs.
        costs: The costs of functions and blocks.
        declarations: Declarations of LLVM intrinsics.
        polls: Whether a loop checks the stop flag.
    """

    def __init__(self, module: Module, lanes: Lanes) -> None:
        self.module = module
        self.lanes = lanes
        self.layout = KernelLayout.of(module)
        self.costs = LaneCosts(module.functions)
        self._chains = Chains(module.functions, self.costs)
        self.declarations: set[str] = set()
        self.polls = False
        self._array_bytes = 0
        self._functions = {f.name: f for f in module.functions}
        self._sites = Counter(
            name for f in module.functions for e in roots_in(f.body) for name in contents(e).callees
        )
        self._variants: dict[tuple[str, int, tuple[bool, ...], bool], tuple[str, bool]] = {}
        self._definitions: list[LlvmFunction | str] = []
        self._tables: dict[Leaves, str] = {}

    def may_be_long(self) -> bool:
        """Return whether the code so far has long loops or large arrays on the stack."""
        return self.polls or self._array_bytes > _SMALL_ARRAY_BYTES

    # Services for the writers of functions

    def take_memory(self, size: int, function: Function) -> None:
        """Add an array's size to the total.

        Args:
            size: Bytes.
            function: The function that contains the array, for the message.

        Raises:
            CompileError: All arrays together are too large.
        """
        self._array_bytes += size
        if self._array_bytes > ARRAY_BYTES:
            raise CompileError.at(
                ErrorCode.TARGET,
                f"the arrays of '{function.source_name}' are too large for the CPU, which keeps "
                f"{self.lanes.count} of each",
                function.span,
                "put constant numbers into a Buffer",
            )

    def arithmetic(self, lanes: Lanes | None = None) -> LaneArithmetic:
        """Return the arithmetic of a new function; ``lanes`` is None for the module's lanes."""
        return LaneArithmetic(lanes or self.lanes, LlvmWriter(), self.declarations)

    def table(self, leaves: Leaves) -> str:
        """Return the name of a constant table, with one slot for each leaf."""
        name = self._tables.get(leaves)
        if name is None:
            name = self._tables[leaves] = f"@table{len(self._tables)}"
            parts = ", ".join(self._table_slot(leaf) for leaf in leaves)
            types = ", ".join(self._slot_type(leaf.kind) for leaf in leaves)
            self._definitions.append(
                f"{name} = private unnamed_addr constant {{ {types} }} {{ {parts} }}, align 64"
            )
        return name

    def _slot_type(self, kind: Kind) -> str:
        if kind is Kind.FLOAT:
            return self.lanes.scalar(kind)
        return "i32" if self.lanes.slot == 4 else "i64"

    def _table_slot(self, leaf: Leaf) -> str:
        value = {"true": "1", "false": "0"}.get(leaf.names[0], leaf.names[0])
        return f"{self._slot_type(leaf.kind)} {value}"

    def call(self, caller: LaneExpressions, name: str, args: tuple[Expr, ...]) -> Leaves:
        """Call a function with the caller's active lanes.

        Args:
            caller: The expressions of the calling function.
            name: The called function.
            args: The arguments.
        """
        function = self._functions[name]
        # The specialise pass has already bound static arguments (textures).
        varying = tuple(caller.uniformity.varies(a) for a in args)
        values = [caller.value(a) for a in args]
        values = [
            caller.arithmetic.spread_all(v) if vary else v
            for v, vary in zip(values, varying, strict=True)
        ]
        mask = caller.mask if any(varying) else None
        if self._inlined(name, caller.arithmetic.lanes):
            return self.run(caller.arithmetic, function, values, varying, mask)
        lanes = caller.arithmetic.lanes
        if lanes.chunks == 1 or not any(varying) or not self._by_chunk(name):
            return self._called(caller.writer, lanes, function, values, varying, mask)
        results = [
            self._chunk_called(caller, c, function, values, varying) for c in range(lanes.chunks)
        ]
        return tuple(_joined(leaves) for leaves in zip(*results, strict=True))

    def _chunk_called(
        self,
        caller: LaneExpressions,
        c: int,
        function: Function,
        values: Sequence[Leaves],
        varying: tuple[bool, ...],
    ) -> Leaves:
        """Write the call of a function for one chunk, skipped if no lane of it is active.

        Args:
            caller: The expressions of the calling function.
            c: The index of the chunk.
            function: The called function.
            values: The leaves of the arguments.
            varying: Which arguments vary between lanes.
        """
        lanes = caller.arithmetic.lanes.one_chunk()
        chunk = [tuple(_chunk(leaf, c) for leaf in value) for value in values]
        mask = None if caller.mask is None else (caller.mask[c],)

        def call() -> Leaves:
            return self._called(caller.writer, lanes, function, chunk, varying, mask)

        if mask is None:
            return call()
        return caller.skipped(caller.arithmetic.any_lane(Leaf(Kind.BOOL, mask, False)), call)

    def _called(
        self,
        writer: LlvmWriter,
        lanes: Lanes,
        function: Function,
        values: Sequence[Leaves],
        varying: tuple[bool, ...],
        mask: Mask,
    ) -> Leaves:
        """Write the call of a function.

        Args:
            writer: The text of the caller.
            lanes: The vector shape of the function.
            function: The called function.
            values: The leaves of the arguments.
            varying: Which arguments vary between lanes.
            mask: The active lanes; None: all.
        """
        symbol, result_varies = self._variant(function, lanes, varying, mask is not None)
        operands = ["ptr %job", *(f"{lanes.vector(Kind.BOOL)} {m}" for m in mask or ())]
        for leaf in (leaf for value in values for leaf in value):
            type = lanes.type(leaf.kind, uniform=leaf.uniform)
            operands += [f"{type} {n}" for n in leaf.names]
        kinds = leaf_kinds(function.result)
        returned = _result_type(lanes, kinds, uniform=not result_varies)
        result = writer.value(f"call {returned} {symbol}({', '.join(operands)})")
        return _unpacked(writer, lanes, result, kinds, uniform=not result_varies)

    def _inlined(self, name: str, lanes: Lanes) -> bool:
        """Return whether to inline a function: if it is small, or has a single call.

        Args:
            name: The function.
            lanes: The vector shape of the caller.
        """
        if self._functions[name].apart:
            return False
        most = INLINE_COST * self.lanes.chunks // lanes.chunks
        if self._sites[name] == 1:
            most = max(most, ONCE_COST)
        return self.costs.function(name) <= most

    def code_of(self, value: Expr) -> int:
        """Return the length of the code of a per-frame value, roughly in instructions."""
        inside = (self.costs.function(name) for name in calls_in(value))
        return size_of(value) + leaf_count(value.type) + sum(c for c in inside if c <= INLINE_COST)

    def _by_chunk(self, name: str) -> bool:
        """Return whether a function is called for each vector of its arguments separately."""
        if self._functions[name].apart:
            return True
        cost = self.costs.function(name)
        rounds = self.costs.rounds_of(name)
        if cost >= LARGE_COST and rounds <= FEW_ROUNDS:
            return True
        return cost >= CHUNK_COST and rounds == 1 and cost >= PARALLEL * self._chains.of(name)

    # Functions

    def _variant(
        self, function: Function, lanes: Lanes, varying: tuple[bool, ...], masked: bool
    ) -> tuple[str, bool]:
        """Return the LLVM function for a set of varying parameters; whether its result varies."""
        key = function.name, lanes.chunks, varying, masked
        known = self._variants.get(key)
        if known is None:
            letters = "".join("v" if v else "u" for v in varying) + ("m" if masked else "")
            letters += "" if lanes.chunks == self.lanes.chunks else f".{lanes.chunks}"
            symbol = f'@"{_escaped(function.name)}.{letters}"'
            # The result varies if one of the arguments does.
            known = self._variants[key] = symbol, any(varying)
            self._define(function, lanes, varying, masked, symbol)
        return known

    def _define(
        self,
        function: Function,
        lanes: Lanes,
        varying: tuple[bool, ...],
        masked: bool,
        symbol: str,
    ) -> None:
        arithmetic = self.arithmetic(lanes)
        writer = arithmetic.writer
        params = [("ptr", "%job")]
        mask: Mask = None
        if masked:
            mask = tuple(f"%mask{c}" for c in range(lanes.chunks))
            params += [(lanes.vector(Kind.BOOL), m) for m in mask]
        bound: list[Leaves] = []
        for p, (param, vary) in enumerate(zip(function.params, varying, strict=True)):
            leaves = []
            for i, kind in enumerate(leaf_kinds(param.type)):
                count = lanes.chunks if vary else 1
                names = tuple(f"%p{p}.{i}.{c}" for c in range(count))
                params += [(lanes.type(kind, uniform=not vary), n) for n in names]
                leaves.append(Leaf(kind, names, not vary))
            bound.append(tuple(leaves))
        prologue(writer)
        result_varies = any(varying)
        result = self.run(arithmetic, function, bound, varying, mask)
        if result_varies:
            result = arithmetic.spread_all(result)
        kinds = leaf_kinds(function.result)
        returned = _result_type(lanes, kinds, uniform=not result_varies)
        packed = "poison"
        for i, (type, name) in enumerate(
            (lanes.type(leaf.kind, uniform=leaf.uniform), name)
            for leaf in result
            for name in leaf.names
        ):
            packed = writer.value(f"insertvalue {returned} {packed}, {type} {name}, {i}")
        writer.line(f"ret {returned} {packed}")
        source = function.source_name
        self.define(LlvmFunction(returned, symbol, params, arithmetic.text(), comment=source))

    def run(
        self,
        arithmetic: LaneArithmetic,
        function: Function,
        args: list[Leaves],
        varying: tuple[bool, ...],
        mask: Mask,
    ) -> Leaves:
        """Write a function's body at the current position.

        Args:
            arithmetic: Writes the operations.
            function: The function.
            args: The leaves of the arguments.
            varying: Which arguments vary between lanes.
            mask: The active lanes; None: all.
        """
        names = frozenset(p.name for p, vary in zip(function.params, varying, strict=True) if vary)
        expressions = LaneExpressions(self, arithmetic, Uniformity(function, names))
        expressions.mask = mask
        statements = Statements(expressions, function)
        for param, leaves in zip(function.params, args, strict=True):
            if param.name in statements.indexed:
                uniform = param.name not in names
                stored = expressions.stored(param.type, leaves, uniform=uniform)
                expressions.environment[param.name] = stored
            else:
                expressions.environment[param.name] = leaves
        statements.block(function.body)
        return statements.result

    # The module

    def define(self, definition: LlvmFunction | str) -> None:
        """Add a definition; as a text, only in a program that is one module."""
        self._definitions.append(definition)

    def program(self, name: str) -> LlvmProgram:
        """Return the whole program."""
        bits = _REGISTER_BITS[self.lanes.level]
        attributes = (
            f'attributes #0 = {{ nounwind "no-builtins" "min-legal-vector-width"="{bits}" '
            f'"prefer-vector-width"="{bits}" }}'
        )
        return LlvmProgram(_escaped(name), self._definitions, sorted(self.declarations), attributes)


def prologue(writer: LlvmWriter) -> None:
    """Load the pointers of a job; unused ones are removed later."""
    for name in ("stop", "uniforms", "frame", "resources"):
        at = writer.value(f"getelementptr i8, ptr %job, i64 {JOB_OFFSET[name]}")
        writer.line(f"%{name} = load ptr, ptr {at}, !invariant.load !0")


def _chunk(leaf: Leaf, c: int) -> Leaf:
    """Return one chunk of a leaf; a uniform leaf is the same in each."""
    return leaf if leaf.uniform else Leaf(leaf.kind, (leaf.names[c],), False)


def _joined(chunks: Leaves) -> Leaf:
    """Return the leaf with these chunks."""
    return Leaf(chunks[0].kind, tuple(chunk.names[0] for chunk in chunks), False)


def _result_type(lanes: Lanes, kinds: tuple[Kind, ...], *, uniform: bool) -> str:
    per_leaf = 1 if uniform else lanes.chunks
    names = (t for k in kinds for t in (lanes.type(k, uniform=uniform),) * per_leaf)
    return f"{{ {', '.join(names)} }}"


def _unpacked(
    writer: LlvmWriter, lanes: Lanes, result: str, kinds: tuple[Kind, ...], *, uniform: bool
) -> Leaves:
    type = _result_type(lanes, kinds, uniform=uniform)
    per_leaf = 1 if uniform else lanes.chunks
    names = [
        writer.value(f"extractvalue {type} {result}, {i}") for i in range(len(kinds) * per_leaf)
    ]
    return tuple(
        Leaf(kind, tuple(names[i * per_leaf : (i + 1) * per_leaf]), uniform)
        for i, kind in enumerate(kinds)
    )


def _escaped(name: str) -> str:
    """Return a name with the escapes of LLVM's quoted names."""
    return "".join(
        chr(b) if 32 <= b < 127 and b not in b'"\\' else f"\\{b:02X}" for b in name.encode()
    )
