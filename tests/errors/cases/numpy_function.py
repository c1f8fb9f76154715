import numpy as np

from distal.lang import func


@func
def scene(x: float) -> float:
    return np.sin(x)
