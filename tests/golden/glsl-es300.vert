#version 300 es
precision highp float;
precision highp int;

uniform float time;

// The per-frame part, handed to the fragment stage.
flat out vec4 packed_0;

// careful.py
float held_angle(float x) {
    return clamp(x, -4194304.0, 4194304.0);
}

// elementary.py
float sine_near_zero(float r) {
    float s = r * r;
    float p = -0.00019809778 + s * 2.6058e-6;
    p = 0.008333069 + s * p;
    p = -0.1666666 + s * p;
    return r + r * s * p;
}

// careful.py
float sine(float x) {
    float held = held_angle(x);
    float n = floor(held * 0.15915494 + 0.25) + 0.25;
    float rest = held - n * 6.28125 - n * 0.0019353072;
    return sine_near_zero(1.5707964 - abs(rest));
}

void main() {
    vec2 corner = vec2(float(gl_VertexID % 2), float(gl_VertexID / 2));
    gl_Position = vec4(4.0 * corner - 1.0, 0.0, 1.0);
    float frame_0 = 1.0 + 0.25 * sine(time);
    packed_0 = vec4(frame_0, 0.0, 0.0, 0.0);
}
