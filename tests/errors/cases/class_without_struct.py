from dataclasses import dataclass

from distal.lang import func


@dataclass
class Hit:
    distance: float


@func
def scene(x: float) -> float:
    return Hit(x).distance
