struct Uniforms {
    resolution: vec2f,
    time: f32,
    filter_: f32,  // Filter, 0.01 to 1.0
    outline: u32,  // Outline
    tile: vec4u,  // the part to compute: corner, size; zeros: the whole picture
}

@group(0) @binding(0) var<uniform> uniforms_input: Uniforms;
var<private> uniforms: Uniforms;

// Values that are the same in all pixels, computed by frame_main.
struct Frame {
    frame_0: f32,
}

@group(0) @binding(1) var<uniform> frame_input: Frame;
var<private> frame: Frame;
@group(0) @binding(2) var<storage, read_write> frame_output: Frame;

@group(0) @binding(3) var<storage, read_write> pixels: array<vec4f>;

struct Nearest {
    distance: f32,
    number: i32,
}

var<private> table = array<f32, 3>(0.2, 0.9, 0.4);

// scene.py:39
fn rotated(p: vec2f, angle: f32) -> vec2f {
    let shared_0 = cos(angle);
    let shared_1 = sin(angle);
    return mat2x2f(vec2f(shared_0, shared_1), vec2f(-shared_1, shared_0)) * p;
}

// scene.py:44
fn ring(p: vec2f, radius: f32) -> f32 {
    return abs(length(p) - radius) - 0.05;
}

// scene.py:49
fn nearest(p: vec2f) -> Nearest {
    var found = Nearest(1000.0, -1);
    for (var i = 0; i < 3; i++) {
        let center = rotated(vec2f(0.5, 0.0), uniforms.time + 2.0 * f32(i));
        let d = ring(p - center, 0.25);
        if (d < found.distance) {
            found.distance = d;
            found.number = i;
        }
    }
    return found;
}

// scene.py:61
fn rings(coord: vec2f) -> vec3f {
    var p = (2.0 * coord - uniforms.resolution) / uniforms.resolution.y;
    p *= frame.frame_0;
    let found = nearest(p);
    if (found.number < 0) {
        return vec3f(0.0);
    }
    var shade = clamp(0.5 - found.distance / uniforms.filter_, 0.0, 1.0);
    if (uniforms.outline != 0u && abs(found.distance) < 0.01) {
        shade = max(round(shade), min(shade, 0.5));
    }
    return mix(vec3f(0.1, 0.1, 0.2), vec3f(table[min(max(found.number, 0), 2)], 0.5, 0.3), shade);
}

// scene.py:61
fn pixel(coord: vec2f) -> vec4f {
    return vec4f(rings(coord), 1.0);
}

@compute @workgroup_size(8, 8)
fn compute_main(@builtin(global_invocation_id) id: vec3u) {
    uniforms = uniforms_input;
    frame = frame_input;
    let part = uniforms.tile;
    let size = select(vec2u(uniforms.resolution), part.zw, part.z > 0u);
    if (id.x >= size.x || id.y >= size.y) {
        return;
    }
    // The picture's top row comes first; coordinates count from the bottom.
    let center = vec2f(id.xy + part.xy) + 0.5;
    let coord = vec2f(center.x, uniforms.resolution.y - center.y);
    pixels[id.y * size.x + id.x] = pixel(coord);
}

// Run once for each picture, before the pixels.
@compute @workgroup_size(1)
fn frame_main() {
    uniforms = uniforms_input;
    let frame_0 = 1.0 + 0.25 * sin(uniforms.time);
    frame_output.frame_0 = frame_0;
}
