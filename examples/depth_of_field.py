"""Beads that repeat without end, through a lens that is sharp on one row of them.

Try: another distance of focus, or an aperture of 0, which shows everything sharp.
"""

from distal import Camera, DistantLight, Plane, Scene, Sky, Sphere, metal, plastic
from distal.lang import slider

SUN = (0.7, 0.5, 0.3)

aperture = slider("Aperture", 0.5, 0.0, 1.0, help="The diameter of the lens.")
focus = slider("Focus", 5.2, 3.0, 20.0, help="The distance at which everything is sharp.")

teal = Sphere(0.36).translate(-0.2, 0.0, -0.2).paint(plastic("#17606b", roughness=0.2))
red = Sphere(0.2).translate(0.36, -0.16, 0.3).paint(plastic("#c8492f", roughness=0.2))
gold = Sphere(0.13).translate(0.4, -0.23, -0.3).paint(metal("#e8b04b", roughness=0.3))
beads = (teal | red | gold).translate(y=0.36).repeat(1.3, 0.0, 1.3)

scene = Scene(
    beads | Plane().paint("#cfc4b0"),
    lights=DistantLight(SUN, intensity=1.7, color="#ffe2bf", angle=0.3),
    camera=Camera(
        (0.3, 1.7, 6.0),
        target=(0.0, 0.3, 0.6),
        fov_deg=32.0,
        aperture=aperture,
        focus_distance=focus,
    ),
    background=Sky(sun=SUN, light=True),
    fog_density=0.03,
    steps=400,
    mode="path",
    tone_map="agx",
)
