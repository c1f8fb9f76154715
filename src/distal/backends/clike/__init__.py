"""The shared part of GLSL and WGSL: functions, statements, expressions and names of C-like text."""
