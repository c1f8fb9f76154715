"""Beads that repeat without end, through a lens that is sharp on one row of them.

Try: another distance of focus, or an aperture of 0, which shows everything sharp.
"""

from distal import Camera, DistantLight, Plane, Scene, Sky, Sphere, metal, plastic
from distal.lang import slider

SUN = (0.7, 0.55, -0.2)

aperture = slider("Aperture", 0.5, 0.0, 1.0, help="The diameter of the lens.")
focus = slider("Focus", 5.2, 3.0, 20.0, help="The distance at which everything is sharp.")

gold = Sphere(0.36).translate(-0.2, 0.0, -0.2).paint(metal("#e8b04b", roughness=0.2))
blue = Sphere(0.2).translate(0.36, -0.16, 0.3).paint(plastic("#1f5f8b"))
coral = Sphere(0.13).translate(0.4, -0.23, -0.3).paint(plastic("#d9533c"))
beads = (gold | blue | coral).translate(y=0.36).repeat(1.3, 0.0, 1.3)

scene = Scene(
    beads | Plane().paint("#d8d3c8"),
    lights=DistantLight(SUN, intensity=2.6, color="#ffe2bf", angle=0.12),
    camera=Camera(
        (0.3, 1.55, 6.0),
        target=(0.0, 0.3, 0.6),
        fov_deg=32.0,
        aperture=aperture,
        focus_distance=focus,
    ),
    background=Sky(sun=SUN, light=True),
    mode="path",
    tone_map="agx",
)
