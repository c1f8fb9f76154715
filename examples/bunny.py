"""A sitting bunny of ellipsoids and capsules that melt into each other, on a sunny meadow.

Turn the camera and change the weight. Try: softness 0 shows the separate pieces.
After the bunny of a graphics blog, whose mouse turned the camera and changed the weight.
"""

from distal import (
    CapsuleBetween,
    Ellipsoid,
    OrbitCamera,
    RoundConeBetween,
    Scene,
    Sphere,
    linear_gradient,
    matte,
    outdoor,
    plastic,
)
from distal.lang import slider

turn = slider("Turn", 0.5, low=-3.15, high=3.15, help="The camera's angle around the bunny.")
weight = slider("Weight", 1.0, low=0.6, high=1.8, help="Above 1 it had too many carrots.")
softness = slider("Softness", 1.0, low=0.0, high=1.5, help="How far the pieces melt.")

BROWN = matte("#c19a76")
FUR = matte(linear_gradient("#f6ecdf", "#bd946e", start=(0.3, 0.0, 0.0), end=(0.05, 0.8, 0.0)))
PINK = matte("#e09a94")
WHITE = matte("#f6efe4")
GRASS = "#5f8048"

fat = weight - 1.0

# It looks along +x; only the side of +z is modelled; the other side mirrors it.
body = Ellipsoid((0.62 + 0.2 * fat, 0.52 + 0.17 * fat, 0.44 * weight)).rotate(z=0.25)
body = body.translate(-0.14, 0.56 + 0.1 * fat, 0.0)
chest = Ellipsoid((0.32, 0.42, 0.3 * weight)).rotate(z=-0.3).translate(0.34, 0.64, 0.0)
haunch = Ellipsoid((0.36, 0.38, 0.26)).translate(-0.32, 0.4, 0.04 + 0.2 * weight)
hind_foot = CapsuleBetween((-0.42, 0.08, 0.0), (0.1, 0.08, 0.06), radius=0.085)
hind_foot = hind_foot.translate(z=0.2 + 0.22 * weight)
leg = CapsuleBetween((0.42, 0.55, 0.17), (0.55, 0.1, 0.17), radius=0.1)
paw = CapsuleBetween((0.5, 0.07, 0.17), (0.68, 0.07, 0.18), radius=0.085)
tail = Sphere(0.17).translate(-0.76 - 0.18 * fat, 0.42, 0.0).paint(WHITE)

head = Ellipsoid((0.36, 0.3, 0.28 + 0.02 * fat)).rotate(z=-0.25).translate(0.56, 1.24, 0.0)
muzzle = Ellipsoid((0.17, 0.14, 0.15)).translate(0.82, 1.13, 0.0)
cheek = Sphere(0.11 + 0.06 * weight).translate(0.68, 1.12, 0.1 + 0.03 * weight)
ear = RoundConeBetween((0.0, 0.0, 0.0), (0.0, 0.6, 0.0), start_radius=0.08, end_radius=0.14)
hollow = ear.scale(0.75).translate(0.0, 0.12, 0.09).cut_material(PINK)
ear = ear.paint(BROWN).difference(hollow, smooth=0.01).scale(1.0, 1.0, 0.6)
ear = ear.rotate(y=0.9).rotate(x=0.16).rotate(z=0.55).translate(0.46, 1.42, 0.1)
eye = Sphere(0.055).translate(0.79, 1.31, 0.2).paint(plastic("#150d0a"))
nose = Sphere(0.04).translate(0.985, 1.17, 0.0).paint(PINK)

trunk = body.union(chest, haunch, smooth=0.04 * softness)
trunk = trunk.union(leg, paw, hind_foot, smooth=0.025 * softness).paint(FUR)
face = head.union(muzzle, cheek, smooth=0.02 * softness).paint(FUR)
face = face.union(ear, smooth=0.015 * softness)
bunny = trunk.union(face, smooth=0.05 * softness).union(tail, smooth=0.015 * softness)
bunny = (bunny | eye | nose).symmetry("z").named("bunny")
meadow = Sphere(25.0).translate(y=-25.0).paint(matte(GRASS)).named("meadow")

scene = Scene(
    bunny | meadow,
    look=outdoor(light_azimuth=-0.8, light_elevation=0.5, horizon="#a9c9e4"),
    floor=False,
    camera=OrbitCamera(5.2, azimuth=turn, elevation=0.2, target=(0.0, 1.0, 0.0), fov_deg=32.0),
    ambient_occlusion=0.35,
    fog_density=0.012,
)
