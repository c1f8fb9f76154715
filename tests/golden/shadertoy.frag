const float filter_ = 0.25;  // Filter, 0.01 to 1.0
const bool outline = true;  // Outline

// Per-frame values that functions read.
float frame_0;

struct Nearest {
    float distance;
    int number;
};

const float[3] table = float[3](0.2, 0.9, 0.4);

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
        vec2 center = rotated(vec2(0.5, 0.0), iTime + 2.0 * float(i));
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
    vec2 p = (2.0 * coord - iResolution.xy) / iResolution.xy.y;
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
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    // Per frame: the same in every pixel, but there is no earlier stage here.
    frame_0 = 1.0 + 0.25 * sin(iTime);
    fragColor = vec4(rings(fragCoord), 1.0);
}
