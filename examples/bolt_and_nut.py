"""A bolt and a nut that fit, to the standard's sizes in millimetres; one nut is on its way down.

A nut is the same thread with a gap of its own. Try: how far the nut is down, and the gap, which
printed parts need; the second bolt is cut open to show it.
"""

from distal import Bolt, Box, Camera, MetricThread, Nut, Plane, Scene, Sky, brass, matte, steel
from distal.lang import slider

down = slider("Nut", 17.0, low=12.0, high=30.0, help="How far below the head the nut is.")
gap = slider("Gap", 0.25, low=0.05, high=0.4, help="Between the two threads, in millimetres.")

STEEL = steel(roughness=0.3)
CUT = matte("#c8553d")

bolt = Bolt("M12", 34.0).paint(STEEL)
nut = Nut("M12", gap=gap)

# Standing on its head, the nut halfway; the first turn is where the thread begins.
whole = (bolt | nut.screwed(-down).paint(brass(roughness=0.25))).rotate(x=3.1415927)

# Cut open along the axis: the teeth of the bolt in those of the nut.
opened = Box(40.0, 90.0, 40.0).translate(z=-20.0)
inner = bolt - opened.cut_material(CUT)
outer = nut.screwed(-17.0).paint(brass(roughness=0.25)) - opened.cut_material(matte("#e3b04b"))
half = (inner | outer).rotate(x=3.1415927).rotate(y=-0.35)

# A rod without a head lies in front.
rod = MetricThread("M8", 40.0).rotate(z=1.5707963).rotate(y=0.5)

scene = Scene(
    (whole.translate(-14.0, 7.5, 0.0) | half.translate(14.0, 7.5, 0.0)).named("bolts")
    | rod.paint(STEEL).translate(-1.0, 4.0, 19.0)
    | Plane(y=0.0).paint("#b9b2a8"),
    camera=Camera((18.0, 46.0, 92.0), target=(0.0, 16.0, 3.0), fov_deg=34.0),
    background=Sky(),
    ambient_occlusion=0.3,
    bounces=2,
)
