from distal.lang import (Texture2D, func, sample, texel, vec3, vec4)

photo = Texture2D([[0.0, 1.0], [1.0, 0.0]])


@func
def scene(p: vec3) -> vec4:
    a = sample(photo, p)
    b = texel(photo, p.xy)
    c = sample(p, p.xy)
    return photo
