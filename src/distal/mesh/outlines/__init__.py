"""Outlines of flat shapes: closed polylines with sharp corners and a measured error.

Input: flat shapes; slices of solids are flat shapes. Output: outlines, and layers of solids.
"""
