from enum import Enum

from distal.lang import func


class Material(Enum):
    WOOD = "wood"
    STONE = 2


@func
def scene(x: float) -> float:
    if x > 1.0:
        return float(Material.STOEN)
    return float(Material.WOOD)
