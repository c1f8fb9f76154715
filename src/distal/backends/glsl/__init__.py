"""GLSL: WebGL 2 (ES 3.00), desktop 3.30, WebGL 1 (ES 1.00), glslCanvas, ISF and Shadertoy."""
