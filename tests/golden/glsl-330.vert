#version 330

uniform float time;

// The per-frame part, handed to the fragment stage.
flat out vec4 packed_0;

void main() {
    int number = gl_VertexID % 3 + gl_VertexID / 3;
    vec2 corner = vec2(float(number % 2), float(number / 2));
    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
    float frame_0 = 1.0 + 0.25 * sin(time);
    packed_0 = vec4(frame_0, 0.0, 0.0, 0.0);
}
