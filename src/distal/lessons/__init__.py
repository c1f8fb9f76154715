"""Lessons: texts with a live picture, experiments and exercises, written as Markdown.

``reading`` reads a lesson's file, ``scenes`` loads its scene and checks its values, ``prose`` makes
HTML of its text, ``page`` writes one page that needs neither a compiler nor a network.
"""
