#version 330

uniform float time;

// The per-frame part, handed to the fragment stage.
flat out vec4 packed_0;

void main() {
    vec2 corner = vec2(float(gl_VertexID % 2), float(gl_VertexID / 2));
    gl_Position = vec4(4.0 * corner - 1.0, 0.0, 1.0);
    float frame_0 = 1.0 + 0.25 * sin(time);
    packed_0 = vec4(frame_0, 0.0, 0.0, 0.0);
}
