"""The record of the tests: which functions of the source each of them runs, and for how long.

``monitor`` and ``plugin`` record, ``rows`` keeps, ``choice`` chooses the tests of ``make test``,
``reach`` finds those that a change can reach. ``python -m tools.record`` is the command.
"""
