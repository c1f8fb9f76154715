#ifdef GL_ES
precision highp float;
precision highp int;
#endif

uniform vec2 u_resolution;
uniform float u_time;
uniform float filter_;  // Filter, 0.01 to 1.0
uniform bool outline;  // Outline

// Per-frame values that functions read.
float frame_0;

struct Nearest {
    float distance;
    int number;
};

// scene.py:39
vec2 rotated(vec2 p, float angle) {
    float shared_0 = cos(angle);
    float shared_1 = sin(angle);
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
        vec2 center = rotated(vec2(0.5, 0.0), u_time + 2.0 * float(i));
        float d = ring(p - center, 0.25);
        if (d < found.distance) {
            found.distance = d;
            found.number = i;
        }
    }
    return found;
}

// rounding.py
float round_half_even(float x) {
    float below = floor(x);
    float over = x - below;
    bool odd = below - 2.0 * floor(below * 0.5) > 0.5;
    return over > 0.5 || (over == 0.5 && odd) ? below + 1.0 : below;
}

// scene.py:61
vec3 rings(vec2 coord) {
    vec2 p = (2.0 * coord - u_resolution) / u_resolution.y;
    p *= frame_0;
    Nearest found = nearest(p);
    if (found.number < 0) {
        return vec3(0.0);
    }
    float shade = clamp(0.5 - found.distance / filter_, 0.0, 1.0);
    if (outline && abs(found.distance) < 0.01) {
        shade = max(round_half_even(shade), min(shade, 0.5));
    }
    return mix(vec3(0.1, 0.1, 0.2),
            vec3(found.number <= 0 ? 0.2 : found.number <= 1 ? 0.9 : 0.4, 0.5, 0.3), shade);
}

// scene.py:61
void main() {
    vec2 coord = gl_FragCoord.xy;
    // Per frame: the same in every pixel, but there is no earlier stage here.
    frame_0 = 1.0 + 0.25 * sin(u_time);
    gl_FragColor = vec4(rings(coord), 1.0);
}
