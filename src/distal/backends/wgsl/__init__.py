"""WGSL for WebGPU: vertex and fragment stages, or a compute program."""
