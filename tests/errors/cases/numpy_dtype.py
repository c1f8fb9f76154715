import numpy as np

from distal.lang import func

NAMES = np.array(["a", "b"])
CUBE = np.zeros((5, 5, 5))


@func
def scene(x: float) -> float:
    a = NAMES[0]
    return x + CUBE[0]
