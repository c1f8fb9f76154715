"""Operators between the plane and space: extrusion, revolution, sweeps, slices, projections."""
