#version 300 es
precision highp float;
precision highp int;

uniform vec2 resolution;
uniform float time;
uniform float filter_;  // Filter, 0.01 to 1.0
uniform bool outline;  // Outline

// Computed once a frame, by the vertex stage.
flat in vec4 packed_0;

// Per-frame values that functions read.
float frame_0;

out vec4 fragment_color;

struct Nearest {
    float distance;
    int number;
};

const float[3] table = float[3](0.2, 0.9, 0.4);

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
#ifdef TRUST_SIN
float sine(float x) { return sin(x); }
#else
float sine(float x) {
    float held = held_angle(x);
    float n = floor(held * 0.15915494 + 0.25) + 0.25;
    float rest = held - n * 6.28125 - n * 0.0019353072;
    return sine_near_zero(1.5707964 - abs(rest));
}
#endif

// careful.py
#ifdef TRUST_COS
float cosine(float x) { return cos(x); }
#else
float cosine(float x) {
    float held = held_angle(x);
    float n = floor(held * 0.15915494 + 0.5);
    float rest = held - n * 6.28125 - n * 0.0019353072;
    return sine_near_zero(1.5707964 - abs(rest));
}
#endif

// scene.py:39
vec2 rotated(vec2 p, float angle) {
    float shared_0 = cosine(angle);
    float shared_1 = sine(angle);
    return mat2(vec2(shared_0, shared_1), vec2(-shared_1, shared_0)) * p;
}

// scene.py:44
float ring(vec2 p, float radius) {
    return abs(length(p) - radius) - 0.05;
}

// scene.py:49
Nearest nearest(vec2 p) {
    Nearest found = Nearest(1000.0, -1);
    for (int i = 0; i < 3; i++) {
        vec2 center = rotated(vec2(0.5, 0.0), time + 2.0 * float(i));
        float d = ring(p - center, 0.25);
        if (d < found.distance) {
            found.distance = d;
            found.number = i;
        }
    }
    return found;
}

// scene.py:61
vec3 rings(vec2 coord) {
    vec2 p = (2.0 * coord - resolution) / resolution.y;
    p *= frame_0;
    Nearest found = nearest(p);
    if (found.number < 0) {
        return vec3(0.0);
    }
    float shade = clamp(0.5 - found.distance / filter_, 0.0, 1.0);
    if (outline && abs(found.distance) < 0.01) {
        shade = max(roundEven(shade), min(shade, 0.5));
    }
    return mix(vec3(0.1, 0.1, 0.2), vec3(table[min(max(found.number, 0), 2)], 0.5, 0.3), shade);
}

// scene.py:61
void main() {
    vec2 coord = gl_FragCoord.xy;
    frame_0 = packed_0.x;
    fragment_color = vec4(rings(coord), 1.0);
}
