"""The sea by sphere tracing: the picture of ``sea``, at several times the cost.

Rays that skim the waves nearly stop: look at ``--view steps`` of both.
"""

from sea import sea

scene = sea(march="sphere", steps=128)
