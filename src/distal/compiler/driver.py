"""The whole compiler pipeline: from scene code to the text for a target.

``lower`` converts the author's function to IR, the passes transform the IR for a target, and a
backend writes the text. Depends on the standard library only.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Collection
from dataclasses import replace
from typing import Final

from distal.backends import emit, get_target, target_names
from distal.backends.base import Artifact
from distal.backends.targets import TextTarget
from distal.compiler.carried import check_numbers, check_resources
from distal.compiler.kept_texts import kept_text
from distal.compiler.prelude_library import PreludeLibrary
from distal.diagnostics import CompileError
from distal.error_codes import ErrorCode
from distal.frontend import lower
from distal.ir.collection import paused_collection
from distal.ir.nodes import Module
from distal.ir.printer import print_module
from distal.ir.target import Target
from distal.ir.verify import Verifier
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.passes.call_order import in_call_order
from distal.passes.context import Context
from distal.passes.pipeline import PASS_NAMES, PIPELINE

# The tests set this. "1": the output of every pass is verified against the rules of the IR.
# "sample": that of every pass for one module of ``VERIFIED_ONE_OF``, of the last pass for all.
VERIFY = os.environ.get("DISTAL_VERIFY", "")
VERIFIED_ONE_OF: Final = 4

IR_TARGET = "ir"  # prints the IR after the CPU's passes
# "numpy", the reference, runs the IR directly and has no text.
# Texts for people have a table of parts only if it makes them much shorter: it needs NumPy.
TEXT_TABLE_FROM: Final = 256
COMPILE_TARGETS: Final = (IR_TARGET, *(name for name in target_names() if name != "numpy"))


def run_passes(
    module: Module,
    target: Target,
    precision: int = 32,
    after: str | None = None,
    skipped: Collection[str] = (),
) -> Module:
    """Run the passes on a lowered module for a target.

    Args:
        module: The lowered module.
        target: The target to compile for.
        precision: The bits of a float, 32 or 64.
        after: The last pass to run; None runs all.
        skipped: Passes that do not run.

    Raises:
        CompileError: The scene code uses something that the target does not support.
    """
    try:
        with paused_collection():
            return _run_passes(module, target, precision, after, skipped)
    except RecursionError:
        # An elif chain of hundreds of branches is a chain of as many nested blocks.
        entry = module.function(module.entry)
        hint = "put parts of it into functions of their own"
        message = f"'{entry.source_name}' or what it calls is too deeply nested"
        raise CompileError.at(ErrorCode.RECURSION, message, entry.span, hint) from None


def _run_passes(
    module: Module, target: Target, precision: int, after: str | None, skipped: Collection[str]
) -> Module:
    context = Context(target, PreludeLibrary(), precision)
    # The passes rely on callees preceding callers, and keep this order; ``verify`` checks it.
    module = replace(module, functions=in_call_order(module.functions, module.entry))
    verifier = Verifier() if VERIFY else None
    is_each_verified = VERIFY == "1" or (VERIFY == "sample" and _is_in_sample(module))
    if verifier is not None and is_each_verified:
        verifier.verify(module)
    last = after or PASS_NAMES[-1]
    for name, run in PIPELINE:
        if name not in skipped:
            module = run(module, context)
        if verifier is not None and (is_each_verified or name == last):
            verifier.verify(module, name)
        if name == last:
            break
    return module


def _is_in_sample(module: Module) -> bool:
    """Whether a module is one of ``VERIFIED_ONE_OF``: the same ones today and tomorrow."""
    span = module.function(module.entry).span
    names = [f"{function.name} {len(function.body)}" for function in module.functions]
    drawn = zlib.crc32(f"{span and span.line} {names}".encode())
    return drawn % VERIFIED_ONE_OF == 0


def compile(obj: Func | Composed, target: str = "glsl-es300", after: str | None = None) -> Artifact:
    """Return the text of a scene, an ``@image`` or a ``@func``; arguments as for ``compiled``."""
    return compiled(obj, target, after)[0]


@paused_collection()
def compiled(
    obj: Func | Composed, target: str, after: str | None = None
) -> tuple[Artifact, Module]:
    """Return the text of a target, and the module before the passes, which has the data.

    Args:
        obj: What to compile. For a ``@func``, the text contains the functions and no entry point
            (``wgsl-compute``: one that calls it for many points).
        target: One of ``COMPILE_TARGETS``: "ir", "llvm", or a text: "glsl-es300", "wgsl" ...
        after: For ``ir``: the pass after which to stop; ``"lower"`` runs no pass.

    Raises:
        CompileError: The scene code has mistakes, or uses something the target does not support.
        ValueError: There is no such target or pass.
        TypeError: ``obj`` is not a scene, an ``@image`` or a ``@func``.
    """
    if not isinstance(obj, Func | Composed):
        kind = type(obj).__name__
        raise TypeError(f"only a scene, an @image or a @func can be compiled, not {kind}")
    if isinstance(obj, Composed):
        obj = obj.emitted()
    if after is not None and after not in ("lower", *PASS_NAMES):
        raise ValueError(f"there is no pass '{after}'; passes: lower, {', '.join(PASS_NAMES)}")
    if after is not None and target != IR_TARGET:
        raise ValueError("only the target 'ir' can stop after a pass")
    if target == IR_TARGET:
        module = lower(obj, table_from=TEXT_TABLE_FROM)
        if after != "lower":
            module = run_passes(module, get_target("llvm"), after=after)
        return Artifact(print_module(module), {}), module
    if target not in COMPILE_TARGETS:
        raise ValueError(f"there is no target '{target}'; targets: {', '.join(COMPILE_TARGETS)}")
    description = get_target(target)
    module = lower(obj, table_from=TEXT_TABLE_FROM if description.buffers else None)
    return kept_text(module, description, lambda: text_of(module, description)), module


def text_of(module: Module, target: Target) -> Artifact:
    """Return the text of a lowered module for a target.

    Args:
        module: The lowered module.
        target: The target.

    Raises:
        CompileError: The scene code uses something that the target does not support, or numbers
            that a shader cannot hold.
    """
    shaped = run_passes(module, target)
    if isinstance(target, TextTarget):
        check_resources(shaped.resources, module, target)
        check_numbers(module, shaped)
    return emit(shaped, target)


__all__ = ["Artifact", "CompileError", "compile", "compiled", "run_passes", "text_of"]
