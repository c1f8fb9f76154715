"""What GLSL and WGSL share: functions, statements, expressions and names of C-like text."""
