"""The tape runtime: straight-line float programs, pruned by intervals, on the CPU.

A *tape* is a list of operations on floats without branches. The runtime evaluates a tape for 64
tiles of a picture at once with intervals, drops in each tile the operands of ``min``, ``max`` and
``select`` that cannot matter there, and repeats this in smaller tiles down to pixels. Its machine
code does not depend on any tape: a new tape compiles nothing.

Input: a function of the IR, or the text of a ``.vm`` file. Output: tapes, and filled pictures.
Does not depend on shapes or scenes.
"""
