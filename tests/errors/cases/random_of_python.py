import random
from random import uniform

import numpy as np

from distal.lang import func, vec3


@func
def scene(p: vec3) -> float:
    a = random.random()
    b = uniform(0.0, 1.0)
    c = np.random.rand()
    return a + b + c
