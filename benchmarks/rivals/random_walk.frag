#version 330
// A walk of uniformly random directions in a hemisphere, which finds lamps by chance alone: the way of
// the article's own renderer. Glass sends light on by Fresnel's equations. The fields are marched.

uniform vec2 u_size;
uniform int u_seed;
uniform int u_count;
out vec4 color;

const float PI = 3.14159265;
const vec3 EYE = vec3(3.0, 1.5, 9.0), TARGET = vec3(0.0, -0.3, 0.0);
const float RADIUS = 0.5;
const vec3 LAMPS[3] = vec3[3](vec3(2.0, 2.5, -2.0), vec3(-2.0, 2.5, 0.0), vec3(2.0, 2.5, 2.0));
const vec3 COLORS[3] = vec3[3](vec3(50.0, 0.0, 0.0), vec3(0.0, 50.0, 0.0), vec3(0.0, 0.0, 50.0));
uint state;

uint pcg(uint x) {
  uint s = x * 747796405u + 2891336453u;
  uint w = ((s >> ((s >> 28u) + 4u)) ^ s) * 277803737u;
  return (w >> 22u) ^ w;
}

float random() {
  state = pcg(state);
  return float(state >> 8u) * (1.0 / 16777216.0);
}

float solids(vec3 p) {
  float ball = length(p - vec3(1.2, 0.0, 0.0)) - 1.0;
  vec3 q = p - vec3(-1.5, -0.2, 0.0);
  q = abs(vec3(0.8660254 * q.x - 0.5 * q.z, q.y, 0.5 * q.x + 0.8660254 * q.z)) - 0.7;
  return min(ball, length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0));
}

float field(vec3 p) { return min(solids(p), p.y + 1.0); }

vec3 normal(vec3 p) {
  vec2 h = vec2(1e-3, 0.0);
  return normalize(vec3(solids(p + h.xyy) - solids(p - h.xyy), solids(p + h.yxy) - solids(p - h.yxy),
                        solids(p + h.yyx) - solids(p - h.yyx)));
}

float fresnel(float cosine, float eta) {
  float g2 = 1.0 - eta * eta * (1.0 - cosine * cosine);
  if (g2 <= 0.0) return 1.0;
  float g = sqrt(g2);
  float s = (eta * cosine - g) / (eta * cosine + g), p = (cosine - eta * g) / (cosine + eta * g);
  return 0.5 * (s * s + p * p);
}

vec3 lamps(vec3 p, vec3 d, float length) {
  vec3 found = vec3(0.0);
  for (int i = 0; i < 3; i++) {
    vec3 to = LAMPS[i] - p;
    float along = dot(to, d), off = dot(to, to) - along * along;
    if (off < RADIUS * RADIUS && along > 0.0 && along < length) found += COLORS[i];
  }
  return found;
}

vec3 walk(vec3 p, vec3 d) {
  vec3 light = vec3(0.0), weight = vec3(1.0);
  bool seen = true;
  float side = 1.0;
  for (int i = 0; i < 16; i++) {
    float t = 0.0;
    bool met = false;
    for (int k = 0; k < 256; k++) {
      float distance = side * field(p + t * d);
      if (distance < 1e-4) { met = true; break; }
      t += distance;
      if (t > 200.0) break;
    }
    if (!seen && side > 0.0) light += weight * lamps(p, d, met ? t : 1e9);
    if (!met) break;
    p += t * d;
    if (p.y + 1.0 < abs(solids(p))) {
      float height = random(), turn = 2.0 * PI * random(), flat_ = sqrt(1.0 - height * height);
      d = vec3(flat_ * cos(turn), height, flat_ * sin(turn));
      weight *= 2.0 * height * 0.6;
      p.y = -1.0 + 1e-3;
      seen = false;
    } else {
      vec3 n = side * normal(p);
      float eta = side > 0.0 ? 1.0 / 1.5 : 1.5;
      if (random() < fresnel(-dot(d, n), eta)) {
        d = reflect(d, n);
        p += 1e-3 * n;
      } else {
        d = refract(d, n, eta);
        p -= 1e-3 * n;
        side = -side;
      }
    }
  }
  return light;
}

void main() {
  state = pcg(uint(gl_FragCoord.x) + pcg(uint(gl_FragCoord.y) + pcg(uint(u_seed))));
  vec3 ahead = normalize(TARGET - EYE), right = normalize(cross(ahead, vec3(0.0, 1.0, 0.0)));
  vec3 up = cross(right, ahead), total = vec3(0.0);
  for (int i = 0; i < u_count; i++) {
    vec2 place = gl_FragCoord.xy - 0.5 + vec2(random(), random());
    vec2 uv = (2.0 * place - u_size) / u_size.y * 0.36397023;
    total += walk(EYE, normalize(ahead + uv.x * right + uv.y * up));
  }
  color = vec4(total / float(u_count), 1.0);
}
