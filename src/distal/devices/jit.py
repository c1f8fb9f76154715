"""Compile LLVM text to machine code. The only module that loads LLVM.

Input: a module's text and a feature level. Output: an object file.
"""

from __future__ import annotations

import ctypes
import importlib
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, wait
from contextlib import suppress
from functools import cache
from typing import Any, Final

from distal.devices.features import CpuLevel, level_named
from distal.devices.features import machine as architecture_here
from distal.devices.kernel_key import optimization
from distal.devices.memory_limit import is_limited, require
from distal.devices.threads import Result, complete, start_threads
from distal.diagnostics import printable
from distal.forking import kept_free
from distal.packages import loading

_LOOK_S: Final = 0.1  # until the main thread looks for ctrl-C
_APART: Final = "from distal.devices.jit import _serve; _serve()"
_LLVM_BYTES: Final = 32 * 2**20  # for LLVM's tables of targets and a loader, with a margin


@cache
def llvm_binding() -> Any:
    """Return LLVM's binding, initialised for this machine; loading it takes 30 to 50 ms."""
    with loading("llvmlite"):
        llvm = importlib.import_module("llvmlite.binding")
        assert llvm.ffi.lib is not None  # loads the library itself
        require(_LLVM_BYTES, "LLVM")
        kept_free(llvm.ffi.lib._lock._lock)  # llvmlite's own
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
    return llvm


def machine_here() -> Any:
    """Return a target machine of this system, for loading code."""
    llvm = llvm_binding()
    return llvm.Target.from_triple(_triple(architecture_here())).create_target_machine(
        codemodel="jitdefault"
    )


def _triple(architecture: str) -> str:
    if architecture != architecture_here():
        return f"{architecture}-unknown-linux-gnu"
    triple: str = llvm_binding().get_process_triple()
    # The loader reads ELF on every system; Windows' format does not support large stacks.
    return f"{triple}-elf" if sys.platform == "win32" else triple


def _passes(llvm: Any, machine: Any) -> tuple[Any, Any]:
    """Return LLVM's passes. They are few, because the IR's passes already inline, fold and share.

    Value numbering and similar passes took 20 ms and made no picture faster.
    """
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    builder = llvm.create_pass_builder(machine, options)
    manager = llvm.create_new_module_pass_manager()
    manager.add_instruction_combine_pass()
    manager.add_simplify_cfg_pass()
    manager.add_aggressive_dce_pass()
    return manager, builder


def compile_object(
    text: str, level: CpuLevel, llvm_level: int | None = None, *, assembly: bool = False
) -> Any:
    """Return the object file of a module, or its assembly text.

    Args:
        text: The module in LLVM's language.
        level: The CPU feature level to compile for.
        llvm_level: LLVM's level of code generation; None: ``optimization()``.
        assembly: Whether to return assembly text.

    Raises:
        PackageError: LLVM is missing or cannot be loaded.
        MemoryError: A limit of this process leaves too little memory for LLVM.
    """
    chosen = optimization() if llvm_level is None else llvm_level
    if is_limited():
        try:
            return compile_apart(text, level, chosen, assembly=assembly)
        except ChildProcessError as error:
            raise MemoryError(f"LLVM cannot compile the scene within ulimit{error}") from None
    return _beside(lambda: _compiled(text, level, chosen, assembly))


def compile_objects(texts: Sequence[str], level: CpuLevel, llvm_level: int) -> list[bytes]:
    """Return the object file of each module; they are compiled at the same time.

    Args:
        texts: The modules in LLVM's language.
        level: The CPU feature level to compile for.
        llvm_level: LLVM's level of code generation.

    Raises:
        PackageError: LLVM is missing or cannot be loaded.
        MemoryError: A limit of this process leaves too little memory for LLVM.
    """
    if len(texts) == 1 or is_limited():
        return [compile_object(text, level, llvm_level) for text in texts]
    return _beside(lambda: _compiled_together(texts, level, llvm_level))


def _compiled_together(texts: Sequence[str], level: CpuLevel, llvm_level: int) -> list[bytes]:
    llvm_binding()
    made: list[Future[bytes]] = [Future() for _ in texts]

    def work(i: int) -> None:
        complete(made[i], lambda: _compiled(texts[i], level, llvm_level, False))

    workers = [threading.Thread(target=work, args=(i,)) for i in range(1, len(texts))]
    started: list[threading.Thread] = []
    with suppress(MemoryError):
        start_threads(workers, started)
    work(0)
    for i in range(1 + len(started), len(texts)):
        work(i)
    return [each.result() for each in made]


def _beside(work: Callable[[], Result]) -> Result:
    """Return the result of some work of LLVM, for which the main thread only waits.

    So ctrl-C takes effect at once, and not after the seconds of a large scene. LLVM then goes on,
    and Python waits for it at its end; a command does not.
    """
    if threading.current_thread() is not threading.main_thread():
        return work()
    ended: Future[Result] = Future()
    try:
        start_threads([threading.Thread(target=complete, args=(ended, work))], [])
    except MemoryError:
        return work()
    while not wait([ended], _LOOK_S).done:  # limited, so that ctrl-C is handled on every platform
        pass
    return ended.result()


def compile_apart(
    text: str, level: CpuLevel, llvm_level: int, *, assembly: bool = False, niceness: int = 0
) -> Any:
    """Return what ``compile_object`` returns, compiled in a process of its own.

    LLVM ends its process if it gets no memory, and a process that ends while a thread is in LLVM
    crashes.

    Args:
        text: The module in LLVM's language.
        level: The CPU feature level to compile for.
        llvm_level: LLVM's level of code generation.
        assembly: Whether to return assembly text.
        niceness: How much the process gives way to others; if it does, ctrl-C does not end it.

    Raises:
        ChildProcessError: The process ended without a result.
    """
    path = os.pathsep.join(filter(None, sys.path))
    words = (level.name, str(llvm_level), str(int(assembly)), str(niceness), str(os.getpid()))
    made = subprocess.run(
        [sys.executable, "-P", "-c", _APART, *words],
        input=text.encode(),
        capture_output=True,
        env={**os.environ, "PYTHONPATH": path},
        start_new_session=niceness > 0,
    )
    if made.returncode != 0:
        last = made.stderr.decode("utf-8", "replace").strip().splitlines()[-1:]
        raise ChildProcessError(f" ({printable(last[0])})" if last else "")
    return made.stdout.decode() if assembly else made.stdout


def _serve() -> None:
    """Compile the text on stdin; runs in the process that ``compile_apart`` starts."""
    name, llvm_level, assembly, niceness, parent = sys.argv[1:]
    threading.Thread(target=_end_with, args=(int(parent),), daemon=True).start()
    if hasattr(os, "nice"):
        os.nice(int(niceness))
    text = sys.stdin.buffer.read().decode()
    made = _compiled(text, level_named(name), int(llvm_level), assembly == "1")
    sys.stdout.buffer.write(made.encode() if isinstance(made, str) else made)
    sys.stdout.flush()


def _end_with(parent: int) -> None:
    """End this process when nobody waits for it any more; Windows does not tell."""
    while os.getppid() == parent:
        time.sleep(_LOOK_S)
    if sys.platform != "win32":
        os._exit(1)


def _compiled(text: str, level: CpuLevel, llvm_level: int, assembly: bool) -> Any:
    llvm = llvm_binding()
    if level.architecture != architecture_here():
        # Initialise all targets, which takes a tenth of a second.
        llvm.initialize_all_targets()
        llvm.initialize_all_asmprinters()
    triple = _triple(level.architecture)
    # macOS reserves x18; on other systems, one register less of thirty does not matter.
    features = "+reserve-x18" if level.architecture == "aarch64" else ""
    machine = llvm.Target.from_triple(triple).create_target_machine(
        cpu=level.cpu, features=features, opt=llvm_level, codemodel="jitdefault"
    )
    # A context of its own: several threads compile at the same time.
    module = llvm.parse_assembly(text, llvm.create_context())
    module.triple = triple
    module.data_layout = str(machine.target_data)
    manager, builder = _passes(llvm, machine)
    if assembly:
        manager.run(module, builder)
        return machine.emit_assembly(module)
    library = llvm.ffi.lib
    _unlocked(library.LLVMPY_RunNewModulePassManager)(manager, module, builder)
    with llvm.ffi.OutputString() as problem:
        emit = _unlocked(library.LLVMPY_TargetMachineEmitToMemory)
        buffer = emit(machine, module, 1, problem)
        if not buffer:
            raise RuntimeError(str(problem))
    try:
        size = library.LLVMPY_GetBufferSize(buffer)
        return ctypes.string_at(library.LLVMPY_GetBufferStart(buffer), size)
    finally:
        library.LLVMPY_DisposeMemoryBuffer(buffer)


def _unlocked(function: Any) -> Any:
    """Return a function of LLVM without llvmlite's lock, which admits one thread at a time.

    LLVM's own rule is that threads use contexts of their own.
    """
    return getattr(function, "_cfn", function)
