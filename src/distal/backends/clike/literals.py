"""Write number literals that are valid in GLSL and WGSL."""

from __future__ import annotations

import struct

from distal.diagnostics import CompileError, Span
from distal.error_codes import ErrorCode

INT_MIN = -(2**31)


def _rounded(value: float) -> float:
    """Return the nearest 32-bit float."""
    result: float = struct.unpack("<f", struct.pack("<f", value))[0]
    return result


def float_literal(value: float, span: Span | None = None) -> str:
    """Return the shortest decimal that reads back as the 32-bit float nearest to ``value``.

    Raises:
        CompileError: The value is too large for 32 bits.
    """
    try:
        single = _rounded(value)
    except OverflowError:
        raise CompileError.at(
            ErrorCode.NUMBER, f"{value!r} is too large for a 32-bit float", span
        ) from None
    for digits in range(9):
        text = f"{single:.{digits}e}"
        try:
            if _rounded(float(text)) == single:
                break
        except OverflowError:  # rounded up past the largest float: more digits are needed
            continue
    mantissa, _, exponent = text.partition("e")
    sign = "-" if mantissa.startswith("-") else ""
    return sign + _positional(mantissa.lstrip("-").replace(".", ""), int(exponent))


def _positional(digits: str, exponent: int) -> str:
    """Return d.ddd times ten to the ``exponent``, without an exponent if that is short."""
    digits = digits.rstrip("0") or "0"
    if digits == "0":
        return "0.0"
    if -5 <= exponent < 0:
        return f"0.{'0' * (-exponent - 1)}{digits}"
    if 0 <= exponent < 9:
        whole = digits[: exponent + 1].ljust(exponent + 1, "0")
        return f"{whole}.{digits[exponent + 1 :] or '0'}"
    fraction = f".{digits[1:]}" if len(digits) > 1 else ""
    return f"{digits[0]}{fraction}e{exponent}"


def int_literal(value: int) -> str:
    """Return a decimal int; the lowest int is a difference, because its magnitude is not an int."""
    return "-2147483647 - 1" if value == INT_MIN else str(value)
