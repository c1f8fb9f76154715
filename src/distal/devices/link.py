"""Object files to images that run wherever they are put.

What flows in: a relocatable ELF object. What flows out: one run of bytes and the offsets of its
exported functions. Calls into the C library go through a table that is filled when the image is
loaded. So a stored kernel needs neither LLVM nor a linker to run again.

The format on every operating system is ELF, the machine code's only contact with the system being
the calling convention. Formats: "Tool Interface Standard (TIS) Portable Formats Specification",
the x86-64 psABI, "ELF for the Arm 64-bit Architecture".
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Final

_ALLOCATED, _WITHOUT_DATA = 2, 8  # section flag SHF_ALLOC, section type SHT_NOBITS
_SYMBOLS, _RELOCATIONS = 2, 4  # SHT_SYMTAB, SHT_RELA
_X86_64, _AARCH64 = 62, 183
_UNDEFINED = 0
_FUNCTION_GLOBAL = 0x12  # STB_GLOBAL, STT_FUNC

# x86-64: jmp *[rip + n] to the address in the slot behind it.
_X86_STUB: Final = b"\xff\x25\x02\x00\x00\x00\x66\x90"
# AArch64: ldr x16, #8; br x16.
_ARM_STUB: Final = struct.pack("<II", 0x58000050, 0xD61F0200)
_STUB_SIZE = 16


class LinkError(Exception):
    """An object file that is not understood: a mistake of ours, never of an author."""


@dataclass(frozen=True, slots=True)
class Image:
    """Machine code and its constants.

    Attributes:
        code: The bytes; to be put at an address that is a multiple of 4096.
        entries: Exported functions and their offsets.
        imports: Functions of the C library and the offsets of the slots for their addresses.
    """

    code: bytes
    entries: dict[str, int]
    imports: dict[str, int]


@dataclass(frozen=True, slots=True)
class _Section:
    name: str
    type: int
    flags: int
    offset: int
    size: int
    link: int
    info: int
    align: int


def link(data: bytes) -> Image:
    """Lay out an object's sections and resolve every reference."""
    if data[:6] != b"\x7fELF\x02\x01":
        raise LinkError("not a little-endian ELF object of 64 bits")
    machine = struct.unpack_from("<H", data, 18)[0]
    sections = _sections(data)
    places, size = _layout(sections)
    image = bytearray(size)
    for index, place in places.items():
        section = sections[index]
        if section.type != _WITHOUT_DATA:
            image[place : place + section.size] = data[section.offset :][: section.size]
    symbols, entries, undefined = _symbols(data, sections, places)
    imports: dict[str, int] = {}
    for number, name in undefined.items():
        place = -len(image) % 16 + len(image)
        stub = _X86_STUB if machine == _X86_64 else _ARM_STUB
        image += bytes(place - len(image)) + stub + bytes(8)
        symbols[number] = place
        imports[name] = place + len(stub)
    for section in sections:
        if section.type == _RELOCATIONS and section.info in places:
            _relocate(data, section, places[section.info], image, symbols, machine)
    return Image(bytes(image), entries, imports)


def _sections(data: bytes) -> list[_Section]:
    start = struct.unpack_from("<Q", data, 40)[0]
    size, count, names = struct.unpack_from("<HHH", data, 58)
    rows = [struct.unpack_from("<IIQQQQIIQQ", data, start + i * size) for i in range(count)]
    strings = rows[names][4]
    return [
        _Section(_string(data, strings + r[0]), r[1], r[2], r[4], r[5], r[6], r[7], r[8])
        for r in rows
    ]


def _string(data: bytes, at: int) -> str:
    return data[at : data.index(0, at)].decode()


def _layout(sections: list[_Section]) -> tuple[dict[int, int], int]:
    """An offset for each section that is there at run time; unwinding tables are left out."""
    places: dict[int, int] = {}
    size = 0
    for index, section in enumerate(sections):
        if section.flags & _ALLOCATED and section.size and section.name != ".eh_frame":
            size += -size % max(1, section.align)
            places[index] = size
            size += section.size
    return places, size


def _symbols(
    data: bytes, sections: list[_Section], places: dict[int, int]
) -> tuple[dict[int, int], dict[str, int], dict[int, str]]:
    """Offsets by symbol number, exported functions by name, and names not defined here."""
    offsets: dict[int, int] = {}
    entries: dict[str, int] = {}
    undefined: dict[int, str] = {}
    for table in sections:
        if table.type != _SYMBOLS:
            continue
        strings = sections[table.link].offset
        for number in range(1, table.size // 24):
            name_at, info, _, section, value, _ = struct.unpack_from(
                "<IBBHQQ", data, table.offset + number * 24
            )
            name = _string(data, strings + name_at)
            if section in places:
                offsets[number] = places[section] + value
                if info == _FUNCTION_GLOBAL:
                    entries[name] = offsets[number]
            elif section == _UNDEFINED and name:
                undefined[number] = name
    return offsets, entries, undefined


def _relocate(
    data: bytes,
    section: _Section,
    base: int,
    image: bytearray,
    symbols: dict[int, int],
    machine: int,
) -> None:
    for at in range(section.offset, section.offset + section.size, 24):
        offset, info, addend = struct.unpack_from("<QQq", data, at)
        number, kind = info >> 32, info & 0xFFFFFFFF
        if number not in symbols:
            raise LinkError(f"a reference to symbol {number}, which has no place")
        place, target = base + offset, symbols[number] + addend
        if machine == _X86_64:
            _relocate_x86(image, kind, place, target)
        elif machine == _AARCH64:
            _relocate_arm(image, kind, place, target)
        else:
            raise LinkError(f"machine {machine}")


def _relocate_x86(image: bytearray, kind: int, place: int, target: int) -> None:
    if kind not in (2, 4):  # R_X86_64_PC32, R_X86_64_PLT32
        raise LinkError(f"x86-64 relocation {kind}")
    struct.pack_into("<i", image, place, target - place)


# Relocation: how far the low twelve bits of the address are shifted into the instruction.
_ARM_LOW_BITS: Final = {277: 0, 278: 0, 284: 1, 285: 2, 286: 3, 299: 4}


def _relocate_arm(image: bytearray, kind: int, place: int, target: int) -> None:
    """References within the image, whose first byte lies at the start of a page."""
    (word,) = struct.unpack_from("<I", image, place)
    match kind:
        case 275:  # R_AARCH64_ADR_PREL_PG_HI21
            pages = (target >> 12) - (place >> 12)
            word |= (pages & 3) << 29 | (pages >> 2 & 0x7FFFF) << 5
        case 282 | 283:  # R_AARCH64_JUMP26, R_AARCH64_CALL26
            word |= (target - place) >> 2 & 0x3FFFFFF
        case 261:  # R_AARCH64_PREL32
            word = (target - place) & 0xFFFFFFFF
        case _ if kind in _ARM_LOW_BITS:
            word |= ((target & 0xFFF) >> _ARM_LOW_BITS[kind]) << 10
        case _:
            raise LinkError(f"AArch64 relocation {kind}")
    struct.pack_into("<I", image, place, word)
