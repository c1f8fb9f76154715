"""The sea by sphere tracing: the picture of ``sea``, at several times the cost.

Rays that pass close above the waves nearly stop: compare ``--view steps`` of both.
"""

from sea import sea

scene = sea(march="sphere", steps=128)
