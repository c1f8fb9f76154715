// A hand-written rival of the raymarcher example for WebGPU: the same scene, algorithm and constants,
// written the way a shader author would. What only changes from frame to frame is computed once per
// pixel, outside the marching loops; the ground's material is asked for once, at the hit.
// Draw three vertices without a buffer, or dispatch a group for each 8x8 pixels; row 0 is the top.

struct Frame {
    resolution: vec2f,
    time: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read_write> pixels: array<vec4f>; // of compute_main alone

const MARCH_STEPS = 96;
const SHADOW_STEPS = 48;
const FAR = 60.0;
const HIT = 0.001;
const GROUND_Y = -0.5;
const BLEND = 0.3;
const SUN = vec3f(-0.39036003, 0.78072006, -0.48795004); // normalize(-.4, .8, -.5)

var<private> ball_y: f32;
var<private> ring_spin: mat2x2f;

fn blob(p: vec3f) -> f32 {
    let ball = length(vec3f(p.x, p.y - ball_y, p.z)) - 0.55;
    let spun = ring_spin * p.xz;
    let ring = length(vec2f(length(spun - vec2f(1.0, 0.0)) - 0.32, p.y)) - 0.12;
    let h = max(BLEND - abs(ball - ring), 0.0) / BLEND;
    return min(ball, ring) - h * h * h * (BLEND / 6.0);
}

fn scene(p: vec3f) -> f32 {
    return min(p.y - GROUND_Y, blob(p));
}

fn normal_at(p: vec3f) -> vec3f {
    const e = vec2f(0.001, 0.0);
    let taps = vec3f(scene(p + e.xyy), scene(p + e.yxy), scene(p + e.yyx));
    return normalize(taps - scene(p));
}

// Distance along the ray, or FAR + 1 where the ray leaves or runs out of steps.
fn march(origin: vec3f, ray: vec3f) -> f32 {
    var t = 0.0;
    for (var i = 0; i < MARCH_STEPS; i++) {
        let d = scene(origin + ray * t);
        if (d < HIT) { return t; }
        t += d;
        if (t > FAR) { break; }
    }
    return FAR + 1.0;
}

fn soft_shadow(origin: vec3f) -> f32 {
    var light = 1.0;
    var t = 0.05;
    for (var i = 0; i < SHADOW_STEPS; i++) {
        let d = scene(origin + SUN * t);
        if (d < HIT) { return 0.0; }
        light = min(light, 32.0 * d / t);
        t += clamp(d, 0.02, 1.0);
        if (t > 10.0) { break; }
    }
    return saturate(light);
}

fn sky(ray: vec3f) -> vec3f {
    let height = saturate(ray.y * 0.5 + 0.5);
    let gradient = mix(vec3f(0.94, 0.78, 0.62), vec3f(0.45, 0.62, 0.85), height);
    return gradient + vec3f(1.0, 0.85, 0.6) * pow(max(dot(ray, SUN), 0.0), 64.0);
}

fn ground_color(p: vec3f) -> vec3f {
    let cell = floor(p.x) + floor(p.z);
    let parity = cell - 2.0 * floor(cell * 0.5);
    return mix(vec3f(0.95, 0.92, 0.85), vec3f(0.30, 0.34, 0.38), parity);
}

fn blob_color(p: vec3f) -> vec3f {
    let pulse = vec3f(0.6, 0.45, 0.4) + 0.4 * cos(frame.time * 0.6 + vec3f(0.0, 0.8, 1.6));
    return pulse * (0.85 + 0.15 * saturate(p.y + 0.5));
}

fn shade(origin: vec3f, ray: vec3f, t: f32) -> vec3f {
    let p = origin + ray * t;
    let n = normal_at(p);
    var albedo: vec3f;
    if (p.y - GROUND_Y < blob(p)) {
        albedo = ground_color(p);
    } else {
        albedo = blob_color(p);
    }
    let key = max(dot(n, SUN), 0.0) * soft_shadow(p + n * 0.001);
    let ambient = 0.25 + 0.25 * (n.y * 0.5 + 0.5);
    let rim = pow(1.0 - max(dot(n, -ray), 0.0), 3.0);
    let lit = albedo * (ambient + key * 0.85) + vec3f(1.0, 0.9, 0.75) * rim * 0.2;
    return mix(lit, sky(ray), saturate(1.0 - exp(-0.02 * t * t)));
}

fn picture(pixel: vec2f) -> vec4f {
    ball_y = 0.2 * sin(frame.time * 1.5);
    let c = cos(frame.time * 0.8);
    let s = sin(frame.time * 0.8);
    ring_spin = mat2x2f(c, s, -s, c);

    let centered = (2.0 * pixel - frame.resolution) / frame.resolution.y;
    let uv = vec2f(centered.x, -centered.y);
    let orbit = frame.time * 0.4;
    let eye = vec3f(3.0 * cos(orbit), 0.8 + 0.2 * sin(frame.time * 0.3), 3.0 * sin(orbit));
    let forward = normalize(-eye);
    let right = normalize(cross(vec3f(0.0, 1.0, 0.0), forward));
    let up = cross(forward, right);
    let ray = normalize(forward * 1.6 + right * uv.x + up * uv.y);

    let t = march(eye, ray);
    var color: vec3f;
    if (t < FAR) {
        color = shade(eye, ray, t);
    } else {
        color = sky(ray);
    }
    return vec4f(color / (1.0 + color), 1.0);
}

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u));
    return vec4f(corner * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment_main(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    return picture(pixel.xy);
}

@compute @workgroup_size(8, 8)
fn compute_main(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2u(frame.resolution);
    if (any(id.xy >= size)) {
        return;
    }
    pixels[id.y * size.x + id.x] = picture(vec2f(id.xy) + 0.5);
}
