"""The jobs of the runtime's exported functions: their fields, and the memory of a thread.

Input: the code of a function that takes a job (see ``layout``). Output: access to its fields.
"""

from __future__ import annotations

from typing import Final

from distal.backends.llvm.lanes import Lanes
from distal.tape.interpreter_loop import vector_type
from distal.tape.layout import (
    FIELD,
    JOB_FIELDS,
    OPERATION_BYTES,
    VIEW_FIELDS,
    VOLUME_FIELDS,
    WORKSPACE,
)
from distal.tape.machine_code import POINTER, WORD, FunctionCode, Value

CHANNELS: Final = "<4 x float>"
PIXEL_BYTES: Final = 16
JOB: Final = "ptr noalias %job"


class ThreadJob:
    """The fields of a job, and the memory of the thread that runs it."""

    def __init__(self, code: FunctionCode, job: Value, workspace: Value) -> None:
        self.code = code
        self.job = job
        self.workspace = workspace

    def word(self, name: str) -> Value:
        """Return a number of the job."""
        return self.code.load(self.job.at(8 * JOB_FIELDS.index(name)))

    def pointer(self, name: str) -> Value:
        """Return a pointer of the job."""
        return self.code.load(self.job.at(8 * JOB_FIELDS.index(name)), POINTER)

    def memory(self, name: str) -> Value:
        """Return the address of a part of the thread's memory."""
        offset = self.pointer("offsets").at(8 * list(WORKSPACE).index(name))
        return self.workspace.at(self.code.load(offset))

    def view(self, name: str) -> Value:
        """Return a number of the view."""
        return self.code.load(self.pointer("view").at(4 * VIEW_FIELDS.index(name)), "float")

    def volume(self, name: str) -> Value:
        """Return a number of the view of a volume."""
        return self.code.load(self.pointer("view").at(4 * VOLUME_FIELDS.index(name)), "float")


def as_float(code: FunctionCode, number: Value) -> Value:
    """Return a whole number as a float."""
    return code.value("float", f"sitofp i64 {number.name} to float")


def result_slot(
    code: FunctionCode, operations: Value, length: Value, slots: Value, size: int
) -> Value:
    """Return the address of the slot of a tape's last operation."""
    last = operations.at((length - 1) * OPERATION_BYTES)
    return slots.at(code.load(last.at(FIELD["result"]), "i16") * size)


def thread_job(code: FunctionCode) -> ThreadJob:
    """Return the job with the memory of this thread, which is the next that no thread has taken."""
    job = ThreadJob(code, code.parameter("job", POINTER), code.parameter("job", POINTER))
    workers = job.pointer("workers")
    number = code.value("i32", f"atomicrmw add ptr {workers.name}, i32 1 monotonic")
    index = code.value(WORD, f"zext i32 {number.name} to i64")
    job.workspace = job.pointer("workspace").at(index * job.word("workspace_bytes"))
    return job


def copy_slot(code: FunctionCode, lanes: Lanes, source: Value, target: Value, size: int) -> None:
    """Copy ``size`` bytes of a slot to memory that need not be aligned."""
    vector = vector_type(lanes)
    for offset in range(0, size, 4 * lanes.width):
        chunk = code.load(source.at(offset), vector, align=64)
        code.store(chunk, target.at(offset), align=4)
