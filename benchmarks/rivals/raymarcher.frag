#version 300 es
// A hand-written rival of the raymarcher example: the same scene, algorithm and constants, written
// the way a shader author would. What only changes from frame to frame is computed once per pixel,
// outside the marching loops; the ground's material is asked for once, at the hit.
precision highp float;

uniform vec2 u_resolution;
uniform float u_time;

out vec4 fragColor;

const int MARCH_STEPS = 96;
const int SHADOW_STEPS = 48;
const float FAR = 60.0;
const float HIT = 0.001;
const float GROUND_Y = -0.5;
const float BLEND = 0.3;
const vec3 SUN = vec3(-0.39036003, 0.78072006, -0.48795004); // normalize(-.4, .8, -.5)

float ballY;
mat2 ringSpin;

float blob(vec3 p) {
    float ball = length(vec3(p.x, p.y - ballY, p.z)) - 0.55;
    vec2 spun = ringSpin * p.xz;
    float ring = length(vec2(length(spun - vec2(1.0, 0.0)) - 0.32, p.y)) - 0.12;
    float h = max(BLEND - abs(ball - ring), 0.0) / BLEND;
    return min(ball, ring) - h * h * h * (BLEND / 6.0);
}

float scene(vec3 p) {
    return min(p.y - GROUND_Y, blob(p));
}

vec3 normalAt(vec3 p) {
    const vec2 e = vec2(0.001, 0.0);
    return normalize(vec3(scene(p + e.xyy), scene(p + e.yxy), scene(p + e.yyx)) - scene(p));
}

// Distance along the ray, or FAR + 1 where the ray leaves or runs out of steps.
float march(vec3 origin, vec3 ray) {
    float t = 0.0;
    for (int i = 0; i < MARCH_STEPS; i++) {
        float d = scene(origin + ray * t);
        if (d < HIT) return t;
        t += d;
        if (t > FAR) break;
    }
    return FAR + 1.0;
}

float softShadow(vec3 origin) {
    float light = 1.0;
    float t = 0.05;
    for (int i = 0; i < SHADOW_STEPS; i++) {
        float d = scene(origin + SUN * t);
        if (d < HIT) return 0.0;
        light = min(light, 32.0 * d / t);
        t += clamp(d, 0.02, 1.0);
        if (t > 10.0) break;
    }
    return clamp(light, 0.0, 1.0);
}

vec3 sky(vec3 ray) {
    float height = clamp(ray.y * 0.5 + 0.5, 0.0, 1.0);
    vec3 gradient = mix(vec3(0.94, 0.78, 0.62), vec3(0.45, 0.62, 0.85), height);
    return gradient + vec3(1.0, 0.85, 0.6) * pow(max(dot(ray, SUN), 0.0), 64.0);
}

vec3 groundColor(vec3 p) {
    float parity = mod(floor(p.x) + floor(p.z), 2.0);
    return mix(vec3(0.95, 0.92, 0.85), vec3(0.30, 0.34, 0.38), parity);
}

vec3 blobColor(vec3 p) {
    vec3 pulse = vec3(0.6, 0.45, 0.4) + 0.4 * cos(u_time * 0.6 + vec3(0.0, 0.8, 1.6));
    return pulse * (0.85 + 0.15 * clamp(p.y + 0.5, 0.0, 1.0));
}

vec3 shade(vec3 origin, vec3 ray, float t) {
    vec3 p = origin + ray * t;
    vec3 n = normalAt(p);
    vec3 albedo = p.y - GROUND_Y < blob(p) ? groundColor(p) : blobColor(p);
    float key = max(dot(n, SUN), 0.0) * softShadow(p + n * 0.001);
    float ambient = 0.25 + 0.25 * (n.y * 0.5 + 0.5);
    float rim = pow(1.0 - max(dot(n, -ray), 0.0), 3.0);
    vec3 lit = albedo * (ambient + key * 0.85) + vec3(1.0, 0.9, 0.75) * rim * 0.2;
    return mix(lit, sky(ray), clamp(1.0 - exp(-0.02 * t * t), 0.0, 1.0));
}

void main() {
    ballY = 0.2 * sin(u_time * 1.5);
    float c = cos(u_time * 0.8);
    float s = sin(u_time * 0.8);
    ringSpin = mat2(c, s, -s, c);

    vec2 uv = (2.0 * gl_FragCoord.xy - u_resolution) / u_resolution.y;
    float orbit = u_time * 0.4;
    vec3 eye = vec3(3.0 * cos(orbit), 0.8 + 0.2 * sin(u_time * 0.3), 3.0 * sin(orbit));
    vec3 forward = normalize(-eye);
    vec3 right = normalize(cross(vec3(0.0, 1.0, 0.0), forward));
    vec3 up = cross(forward, right);
    vec3 ray = normalize(forward * 1.6 + right * uv.x + up * uv.y);

    float t = march(eye, ray);
    vec3 color = t < FAR ? shade(eye, ray, t) : sky(ray);
    fragColor = vec4(color / (1.0 + color), 1.0);
}
