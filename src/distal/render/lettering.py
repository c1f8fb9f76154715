"""Small texts in a picture: numbers and words in glyphs of five by seven squares.

Input: a place in squares, from the text's lower left. Output: whether a glyph covers it. Glyphs are
drawn by arithmetic, so that every target can draw them.
"""

from __future__ import annotations

from distal.lang import abs, clamp, floor, func, ivec3, ivec4, log2, max, min, vec2

ADVANCE = 6.0  # squares from one glyph to the next
HEIGHT = 7.0
# The rows of each glyph from the top, five squares each; the first glyph is the blank.
GLYPHS = {
    " ": "00000 00000 00000 00000 00000 00000 00000",
    "0": "01110 10001 10011 10101 11001 10001 01110",
    "1": "00100 01100 00100 00100 00100 00100 01110",
    "2": "01110 10001 00001 00010 00100 01000 11111",
    "3": "11111 00010 00100 00010 00001 10001 01110",
    "4": "00010 00110 01010 10010 11111 00010 00010",
    "5": "11111 10000 11110 00001 00001 10001 01110",
    "6": "00110 01000 10000 11110 10001 10001 01110",
    "7": "11111 00001 00010 00100 01000 01000 01000",
    "8": "01110 10001 10001 01110 10001 10001 01110",
    "9": "01110 10001 10001 01111 00001 00010 01100",
    "-": "00000 00000 00000 11111 00000 00000 00000",
    ".": "00000 00000 00000 00000 00000 01100 01100",
    "_": "00000 00000 00000 00000 00000 00000 11111",
    "A": "01110 10001 10001 11111 10001 10001 10001",
    "B": "11110 10001 10001 11110 10001 10001 11110",
    "C": "01110 10001 10000 10000 10000 10001 01110",
    "D": "11100 10010 10001 10001 10001 10010 11100",
    "E": "11111 10000 10000 11110 10000 10000 11111",
    "F": "11111 10000 10000 11110 10000 10000 10000",
    "G": "01110 10001 10000 10111 10001 10001 01111",
    "H": "10001 10001 10001 11111 10001 10001 10001",
    "I": "01110 00100 00100 00100 00100 00100 01110",
    "J": "00111 00010 00010 00010 00010 10010 01100",
    "K": "10001 10010 10100 11000 10100 10010 10001",
    "L": "10000 10000 10000 10000 10000 10000 11111",
    "M": "10001 11011 10101 10101 10001 10001 10001",
    "N": "10001 10001 11001 10101 10011 10001 10001",
    "O": "01110 10001 10001 10001 10001 10001 01110",
    "P": "11110 10001 10001 11110 10000 10000 10000",
    "Q": "01110 10001 10001 10001 10101 10010 01101",
    "R": "11110 10001 10001 11110 10100 10010 10001",
    "S": "01111 10000 10000 01110 00001 00001 11110",
    "T": "11111 00100 00100 00100 00100 00100 00100",
    "U": "10001 10001 10001 10001 10001 10001 01110",
    "V": "10001 10001 10001 10001 10001 01010 00100",
    "W": "10001 10001 10001 10101 10101 10101 01010",
    "X": "10001 10001 01010 00100 01010 10001 10001",
    "Y": "10001 10001 10001 01010 00100 00100 00100",
    "Z": "11111 00001 00010 00100 01000 10000 11111",
}
_ROWS = [rows.replace(" ", "") for rows in GLYPHS.values()]
# One bit for each square, in two numbers that 32-bit floats hold exactly: the upper four rows and
# the lower three.
UPPER = [int(rows[:20], 2) for rows in _ROWS]
LOWER = [int(rows[20:], 2) for rows in _ROWS]
COUNT = len(GLYPHS)
DIGIT = 1  # the glyph of the digit 0
MINUS = list(GLYPHS).index("-")
POINT = list(GLYPHS).index(".")
LETTERS = 16  # of a word


def word(text: str) -> tuple[int, int, int, int]:
    """Return a word of up to 16 letters, four to a number; longer ones are cut.

    Letters become capitals; characters without a glyph become blanks.
    """
    known = list(GLYPHS)
    codes = [known.index(c) if c in GLYPHS else 0 for c in text.upper()[:LETTERS]]
    codes += [0] * (LETTERS - len(codes))
    packed = [sum(codes[i + k] * 64**k for k in range(4)) for i in range(0, LETTERS, 4)]
    return packed[0], packed[1], packed[2], packed[3]


@func
def glyph_covers(glyph: int, square: vec2) -> bool:
    """Return whether a glyph covers a square; (0, 0) is at the glyph's lower left."""
    if square.x < 0.0 or square.x > 4.0 or square.y < 0.0 or square.y > 6.0:
        return False
    low = square.y < 3.0
    known = clamp(glyph, 0, COUNT - 1)
    bits = float(LOWER[known]) if low else float(UPPER[known])
    row = square.y if low else square.y - 3.0
    bit = 4.0 - square.x + 5.0 * row
    shifted: float = floor(bits / 2.0**bit + 1e-4)
    return shifted % 2.0 > 0.5


@func
def word_covers(letters: ivec4, place: vec2) -> bool:
    """Return whether a word covers a place, in squares from its lower left."""
    square = floor(place)
    column = floor(square.x / ADVANCE)
    if column < 0.0 or column > 15.0 or square.y < 0.0 or square.y > 6.0:
        return False
    quarter = int(column) // 4
    packed = letters.x if quarter == 0 else letters.y
    if quarter > 1:
        packed = letters.z if quarter == 2 else letters.w
    for i in range(3):
        if i < int(column) - 4 * quarter:
            packed = packed // 64
    return glyph_covers(packed % 64, vec2(square.x - ADVANCE * column, square.y))


@func
def decimals_for(value: float, digits: int) -> int:
    """Return how many decimals show a number with so many digits: 0 to 4."""
    whole = floor(log2(max(abs(value), 1e-9)) * 0.30103 + 1e-4)
    return clamp(digits - 1 - int(whole), 0, 4)


@func
def number_glyphs(value: float, decimals: int) -> ivec3:
    """Return the digits, without point and sign, as one number; their count; 1 if negative."""
    scaled = abs(value) * 10.0 ** float(decimals)
    digits = int(min(floor(scaled + 0.5), 2.0e9))
    count = 1
    rest = digits
    for _ in range(9):
        rest = rest // 10
        if rest > 0:
            count += 1
    return ivec3(digits, max(count, decimals + 1), 1 if value < 0.0 and digits > 0 else 0)


@func
def number_width(value: float, decimals: int) -> float:
    """Return the width of a number in squares, without the space after it."""
    glyphs = number_glyphs(value, decimals)
    points = 1 if decimals > 0 else 0
    return ADVANCE * float(glyphs.y + glyphs.z + points) - 1.0


@func
def number_covers(value: float, decimals: int, place: vec2) -> bool:
    """Return whether a number covers a place.

    Args:
        value: The number.
        decimals: Digits after the decimal point.
        place: In squares from the number's lower right.
    """
    square = floor(place)
    column = floor((-square.x - 1.0) / ADVANCE + 1e-4)
    if column < 0.0 or column > 12.0 or square.y < 0.0 or square.y > 6.0:
        return False
    cell = int(column)
    glyphs = number_glyphs(value, decimals)
    within = vec2(square.x + ADVANCE * column + 5.0, square.y)
    if decimals > 0:
        if cell == decimals:
            return glyph_covers(POINT, within)
        if cell > decimals:
            cell -= 1
    if cell == glyphs.y and glyphs.z == 1:
        return glyph_covers(MINUS, within)
    if cell >= glyphs.y:
        return False
    digits = glyphs.x
    for i in range(9):
        if i < cell:
            digits = digits // 10
    return glyph_covers(DIGIT + digits % 10, within)
