"""Signatures of the shapes' classes. Made by tools/gen_shapes_stub.py."""

from collections.abc import Sequence
from os import PathLike
from typing import Any, TypeAlias

from distal.lang.expressions import Expression
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer, TextureValue
from distal.scene.objects.shape import Shape, Shape2D

Number: TypeAlias = float | Parameter | Expression
Vector: TypeAlias = Sequence[Number] | Parameter | Expression | Any
Points: TypeAlias = Sequence[Sequence[float]] | Buffer | Any
Image: TypeAlias = TextureValue | str | PathLike[str]

class HalfPlane(Shape2D):
    """All that lies behind a straight line."""

    def __init__(self, normal: Vector = ..., offset: Number = 0.0) -> None: ...

class Rectangle(Shape2D):
    """Rectangle with sides along the axes."""

    def __init__(self, size: Vector = ...) -> None: ...

class RoundedRectangle(Shape2D):
    """Rectangle whose corners are rounded, each by its own radius."""

    def __init__(self, size: Vector = ..., radii: Vector = ...) -> None: ...

class ChamferedRectangle(Shape2D):
    """Rectangle whose corners are cut off at 45 degrees."""

    def __init__(self, size: Vector = ..., chamfer: Number = 0.2) -> None: ...

class OrientedRectangle(Shape2D):
    """A bar with square ends between two points."""

    def __init__(
        self,
        start: Vector = ...,
        end: Vector = ...,
        thickness: Number = 0.25,
    ) -> None: ...

class Cross(Shape2D):
    """Two equal bars across each other."""

    def __init__(self, span: Number = 1.0, thickness: Number = 0.3) -> None: ...

class Tunnel(Shape2D):
    """Half a disc on top of two walls; the disc's centre is the origin."""

    def __init__(self, width: Number = 1.0, height: Number = 0.5) -> None: ...

class Stairs(Shape2D):
    """A flight of stairs that climbs to the right, with what is below it; starts at the origin."""

    def __init__(self, step: Vector = ..., count: int = 4) -> None: ...

class Parabola(Shape2D):
    """All that lies above the parabola y = curvature x^2."""

    def __init__(self, curvature: Number = 1.0) -> None: ...

class ParabolaSegment(Shape2D):
    """What a parabola cuts off above the x axis."""

    def __init__(self, width: Number = 1.0, height: Number = 0.8) -> None: ...

class QuadraticCircle(Shape2D):
    """Nearly a circle, of four parabolas: each joins two axes and leaves them at right angles."""

    def __init__(self, radius: Number = 0.5) -> None: ...

class BlobbyCross(Shape2D):
    """Four points on the axes, joined by parabolas that are drawn in toward the middle."""

    def __init__(self, radius: Number = 0.6, depth: Number = 0.15) -> None: ...

class Ellipse(Shape2D):
    """Ellipse with its axes along x and y."""

    def __init__(self, radii: Vector = ...) -> None: ...

class Hyperbola(Shape2D):
    """All that lies beyond the two branches of a hyperbola, to the left and to the right."""

    def __init__(self, radius: Number = 0.4, steepness: Number = 1.0) -> None: ...

class Vesica(Shape2D):
    """What two equal discs have in common: a lens with its tips on the y axis."""

    def __init__(self, width: Number = 0.6, height: Number = 1.0) -> None: ...

class OrientedVesica(Shape2D):
    """A lens between two points."""

    def __init__(self, start: Vector = ..., end: Vector = ..., width: Number = 0.5) -> None: ...

class Moon(Shape2D):
    """A disc around the origin less a second disc to its right."""

    def __init__(
        self,
        radius: Number = 0.7,
        cut_radius: Number = 0.6,
        offset: Number = 0.4,
    ) -> None: ...

class CircleCross(Shape2D):
    """A star of four points with sides of circles, hollow between the points."""

    def __init__(self, width: Number = 1.0, height: Number = 0.8) -> None: ...

class Heart(Shape2D):
    """A square on its corner with half a disc on each upper side."""

    def __init__(self, height: Number = 1.0) -> None: ...

class UnevenCapsule(Shape2D):
    """Two discs, one above the other, and all between their common tangents."""

    def __init__(self, bottom: Number = 0.4, top: Number = 0.2, height: Number = 0.6) -> None: ...

class Egg(Shape2D):
    """Two discs, one above the other, and bulging sides that go smoothly over into both."""

    def __init__(
        self,
        bottom: Number = 0.4,
        top: Number = 0.2,
        height: Number = 0.4,
        bulge: Number = 0.6,
    ) -> None: ...

class RoundedX(Shape2D):
    """Two bars with round ends along the diagonals."""

    def __init__(self, span: Number = 1.2, thickness: Number = 0.25) -> None: ...

class Segment(Shape2D):
    """A straight line with round ends."""

    def __init__(self, start: Vector = ..., end: Vector = ..., radius: Number = 0.05) -> None: ...

class QuadraticBezier(Shape2D):
    """A line along a quadratic Bézier curve."""

    def __init__(
        self,
        start: Vector = ...,
        control: Vector = ...,
        end: Vector = ...,
        radius: Number = 0.05,
    ) -> None: ...

class CubicBezier(Shape2D):
    """A line along a cubic Bézier curve, followed by pairs of parabolas."""

    def __init__(
        self,
        start: Vector = ...,
        leaving: Vector = ...,
        arriving: Vector = ...,
        end: Vector = ...,
        radius: Number = 0.05,
        pieces: int = 4,
    ) -> None: ...

class SplinePath(Shape2D):
    """A smooth line through points, made of two parabolas between each two."""

    def __init__(
        self,
        points: Points = ...,
        radius: Number = 0.05,
        closed: bool = False,
    ) -> None: ...

class Circle(Shape2D):
    """Disc around the origin."""

    def __init__(self, radius: Number = 1.0) -> None: ...

class Annulus(Shape2D):
    """Ring all around."""

    def __init__(self, radius: Number = 0.75, thickness: Number = 0.25) -> None: ...

class Pie(Shape2D):
    """Sector of a disc around the y axis."""

    def __init__(self, radius: Number = 1.0, angle: Number = 0.7) -> None: ...

class CutDisk(Shape2D):
    """What a level line leaves of a disc, above it."""

    def __init__(self, radius: Number = 1.0, height: Number = -0.3) -> None: ...

class Arc(Shape2D):
    """Part of a ring with round ends, around the y axis."""

    def __init__(
        self,
        radius: Number = 0.75,
        angle: Number = 1.6,
        thickness: Number = 0.2,
    ) -> None: ...

class Ring(Shape2D):
    """Part of a ring with straight ends, around the y axis."""

    def __init__(
        self,
        radius: Number = 0.75,
        angle: Number = 1.6,
        thickness: Number = 0.25,
    ) -> None: ...

class Horseshoe(Shape2D):
    """Part of a ring around the y axis, prolonged straight at both ends."""

    def __init__(
        self,
        radius: Number = 0.5,
        angle: Number = 1.9,
        legs: Number = 0.4,
        thickness: Number = 0.25,
    ) -> None: ...

class CircleWave(Shape2D):
    """A wave of arcs along the x axis without end, a crest at x = 0."""

    def __init__(
        self,
        radius: Number = 0.25,
        angle: Number = 1.8,
        thickness: Number = 0.05,
    ) -> None: ...

class CoolS(Shape2D):
    """The S of 14 straight lines."""

    def __init__(self, height: Number = 1.0, thickness: Number = 0.03) -> None: ...

class ArchimedeanSpiral(Shape2D):
    """A line that winds outwards by the same amount each turn, counterclockwise from the x axis."""

    def __init__(
        self,
        inner: Number = 0.1,
        outer: Number = 1.0,
        turns: int = 3,
        radius: Number = 0.04,
    ) -> None: ...

class LogarithmicSpiral(Shape2D):
    """A line that winds outwards by the same factor each turn, counterclockwise from the x axis."""

    def __init__(
        self,
        inner: Number = 0.05,
        outer: Number = 1.0,
        turns: int = 3,
        radius: Number = 0.02,
    ) -> None: ...

class Polygon(Shape2D):
    """Any polygon; where it crosses itself, inside is what it goes around an odd number of times."""

    def __init__(self, points: Points = ...) -> None: ...

class RoundedPolygon(Shape2D):
    """A polygon grown by a radius, so that its outer corners are round."""

    def __init__(self, points: Points = ..., radius: Number = 0.1) -> None: ...

class Polyline(Shape2D):
    """A line through points, as wide as a disc drawn along it."""

    def __init__(
        self,
        points: Points = ...,
        radius: Number = 0.05,
        closed: bool = False,
    ) -> None: ...

class Rhombus2(Shape2D):
    """Rhombus with its diagonals along the axes."""

    def __init__(self, size: Vector = ...) -> None: ...

class IsoscelesTrapezoid(Shape2D):
    """Trapezoid whose slanted sides mirror each other; halfway up at y = 0."""

    def __init__(self, bottom: Number = 1.0, top: Number = 0.6, height: Number = 0.7) -> None: ...

class Parallelogram(Shape2D):
    """Parallelogram with two sides along x."""

    def __init__(self, width: Number = 0.8, height: Number = 0.6, skew: Number = 0.3) -> None: ...

class EquilateralTriangle(Shape2D):
    """Triangle with equal sides, a corner up, its middle at the origin."""

    def __init__(self, size: Number = 1.0) -> None: ...

class IsoscelesTriangle(Shape2D):
    """Triangle with its tip up, halfway up at y = 0."""

    def __init__(self, width: Number = 0.8, height: Number = 1.0) -> None: ...

class Triangle2(Shape2D):
    """Triangle between three points of the plane."""

    def __init__(self, first: Vector = ..., second: Vector = ..., third: Vector = ...) -> None: ...

class Pentagon(Shape2D):
    """Regular polygon with five corners, one of them up."""

    def __init__(self, radius: Number = 0.5) -> None: ...

class Hexagon(Shape2D):
    """Regular polygon with six corners, one of them up."""

    def __init__(self, radius: Number = 0.5) -> None: ...

class Octagon(Shape2D):
    """Regular polygon with eight corners, one of them up."""

    def __init__(self, radius: Number = 0.5) -> None: ...

class RegularPolygon(Shape2D):
    """Polygon with equal sides and angles, a corner up."""

    def __init__(self, radius: Number = 0.5, count: int = 7) -> None: ...

class Hexagram(Shape2D):
    """Star of two triangles, six points, one of them up."""

    def __init__(self, radius: Number = 0.5) -> None: ...

class Pentagram(Shape2D):
    """Star drawn by the diagonals of a pentagon, five points, one of them up."""

    def __init__(self, radius: Number = 0.5) -> None: ...

class RegularStar(Shape2D):
    """Star with equal points, one of them up."""

    def __init__(self, radius: Number = 0.5, inner: Number = 0.25, count: int = 7) -> None: ...

class GearProfile(Shape2D):
    """A gear with involute teeth, one of them up; gears of one tooth size mesh."""

    def __init__(
        self,
        radius: Number = 0.5,
        pressure_angle: Number = 0.3490658503988659,
        count: int = 12,
    ) -> None: ...

class TangentCam(Shape2D):
    """A cam with straight flanks that turns about the origin, its nose up."""

    def __init__(self, base: Number = 0.4, nose: Number = 0.15, lift: Number = 0.3) -> None: ...

class ArcCam(Shape2D):
    """A cam with round flanks that turns about the origin, its nose up."""

    def __init__(
        self,
        base: Number = 0.4,
        nose: Number = 0.15,
        lift: Number = 0.3,
        bulge: Number = 0.4,
    ) -> None: ...

class ImageField(Shape2D):
    """A shape whose distances are the texels of an image, in their first channel."""

    def __init__(self, image: Image = ..., size: Vector = ..., scale: Number = 1.0) -> None: ...

class ValueNoiseSolid(Shape):
    """Lumps of value noise, in line with the axes."""

    def __init__(self, cell_size: Number = 0.5, level: Number = 0.0, seed: int = 0) -> None: ...

class GradientNoiseSolid(Shape):
    """Lumps of Perlin's noise."""

    def __init__(self, cell_size: Number = 0.5, level: Number = 0.0, seed: int = 0) -> None: ...

class SimplexNoiseSolid(Shape):
    """Lumps of simplex noise, rounder and smaller than those of Perlin's."""

    def __init__(self, cell_size: Number = 0.5, level: Number = 0.0, seed: int = 0) -> None: ...

class FbmSolid(Shape):
    """Rugged lumps: noise at several scales."""

    def __init__(
        self,
        cell_size: Number = 1.0,
        level: Number = 0.0,
        octaves: int = 4,
        lacunarity: Number = 2.0,
        gain: Number = 0.5,
        seed: int = 0,
    ) -> None: ...

class VoronoiWalls(Shape):
    """The walls between the cells of scattered points: a closed foam, without end."""

    def __init__(
        self,
        cell_size: Number = 0.5,
        thickness: Number = 0.08,
        jitter: Number = 0.8,
        seed: int = 0,
    ) -> None: ...

class VoronoiCells(Shape):
    """The cells of scattered points, a gap between them: rubble, packed grains, without end."""

    def __init__(
        self,
        cell_size: Number = 0.5,
        gap: Number = 0.08,
        jitter: Number = 0.8,
        seed: int = 0,
    ) -> None: ...

class VoronoiLines(Shape2D):
    """The borders between the cells of points scattered in the plane, without end."""

    def __init__(
        self,
        cell_size: Number = 0.5,
        thickness: Number = 0.08,
        jitter: Number = 0.8,
        seed: int = 0,
    ) -> None: ...

class ScatteredBalls(Shape):
    """Balls around scattered points, or all that is not in them: gravel, a sponge, without end."""

    def __init__(
        self,
        cell_size: Number = 0.5,
        radius: Number = 0.2,
        jitter: Number = 0.8,
        seed: int = 0,
        holes: bool = False,
    ) -> None: ...

class Corner(Shape):
    """The eighth of space where x, y and z are all negative."""

    def __init__(self) -> None: ...

class Box(Shape):
    """Box."""

    def __init__(self, size: Vector = ...) -> None: ...

class BoxCheap(Shape):
    """Box without a square root; outside, off the faces, the value is less than the distance."""

    def __init__(self, size: Vector = ...) -> None: ...

class RoundBox(Shape):
    """Box whose edges are rounded inward: the full size stays."""

    def __init__(self, size: Vector = ..., rounding: Number = 0.1) -> None: ...

class ChamferBox(Shape):
    """Box with every edge cut off at 45 degrees; outside a lower bound."""

    def __init__(self, size: Vector = ..., chamfer: Number = 0.1) -> None: ...

class BoxFrame(Shape):
    """The twelve edges of a box as square beams."""

    def __init__(self, size: Vector = ..., thickness: Number = 0.1) -> None: ...

class RoundFrame(Shape):
    """The twelve edges of a box as round bars with balls at the corners."""

    def __init__(self, size: Vector = ..., thickness: Number = 0.1) -> None: ...

class Helix(Shape):
    """A tube that winds around the y axis without end, through the x axis, rising toward z."""

    def __init__(self, major: Number = 0.5, minor: Number = 0.1, pitch: Number = 0.4) -> None: ...

class Spring(Shape):
    """A coil spring around the y axis, its ends ground flat."""

    def __init__(
        self,
        major: Number = 0.4,
        minor: Number = 0.07,
        pitch: Number = 0.25,
        height: Number = 1.0,
    ) -> None: ...

class InfiniteCone(Shape):
    """Cone without end, downward from its tip at the origin."""

    def __init__(self, angle: Number = 0.5) -> None: ...

class CappedCone(Shape):
    """Upright cone with its tip cut off."""

    def __init__(self, bottom: Number = 0.6, top: Number = 0.3, height: Number = 1.0) -> None: ...

class CappedConeBetween(Shape):
    """Cut cone whose ends are centred at two points."""

    def __init__(
        self,
        start: Vector = ...,
        end: Vector = ...,
        start_radius: Number = 0.6,
        end_radius: Number = 0.3,
    ) -> None: ...

class Cone(Shape):
    """Upright cone, its tip on top."""

    def __init__(self, radius: Number = 0.5, height: Number = 1.0) -> None: ...

class ConeCheap(Shape):
    """Upright cone by its side and its base alone; beyond tip and rim less than the distance."""

    def __init__(self, radius: Number = 0.5, height: Number = 1.0) -> None: ...

class ConeBetween(Shape):
    """Cone from the centre of its base to its tip."""

    def __init__(self, start: Vector = ..., end: Vector = ..., radius: Number = 0.5) -> None: ...

class RoundCone(Shape):
    """Two balls, one above the other, and the cone that touches both."""

    def __init__(self, bottom: Number = 0.5, top: Number = 0.25, height: Number = 1.0) -> None: ...

class RoundConeBetween(Shape):
    """Two balls around two points, and the cone that touches both."""

    def __init__(
        self,
        start: Vector = ...,
        end: Vector = ...,
        start_radius: Number = 0.5,
        end_radius: Number = 0.25,
    ) -> None: ...

class CutSphere(Shape):
    """What a level plane leaves of a ball: the part above."""

    def __init__(self, radius: Number = 1.0, height: Number = 0.25) -> None: ...

class CutHollowSphere(Shape):
    """Bowl: what lies below a level plane of a ball's wall, with a round rim."""

    def __init__(
        self,
        radius: Number = 0.9,
        height: Number = 0.25,
        thickness: Number = 0.1,
    ) -> None: ...

class DeathStar(Shape):
    """Ball with a hollow that another ball above it leaves."""

    def __init__(
        self,
        radius: Number = 1.0,
        cut_radius: Number = 0.75,
        distance: Number = 1.25,
    ) -> None: ...

class SolidAngle(Shape):
    """The part of a ball that lies within an angle of the y axis, its tip at the origin."""

    def __init__(self, angle: Number = 0.6, radius: Number = 1.0) -> None: ...

class VesicaSolid(Shape):
    """Upright body between two arcs, with a tip at either end, like a grain of rice."""

    def __init__(self, height: Number = 1.5, width: Number = 0.75) -> None: ...

class VesicaBetween(Shape):
    """Body between two arcs that meet in two given points."""

    def __init__(self, start: Vector = ..., end: Vector = ..., width: Number = 0.5) -> None: ...

class InfiniteCylinder(Shape):
    """Round bar along the y axis, without end."""

    def __init__(self, radius: Number = 0.5) -> None: ...

class Cylinder(Shape):
    """Upright cylinder."""

    def __init__(self, radius: Number = 0.5, height: Number = 1.0) -> None: ...

class CylinderBetween(Shape):
    """Cylinder whose ends are centred at two points."""

    def __init__(self, start: Vector = ..., end: Vector = ..., radius: Number = 0.5) -> None: ...

class RoundedCylinder(Shape):
    """Upright cylinder whose edges are rounded inward: the full size stays."""

    def __init__(
        self,
        radius: Number = 0.5,
        height: Number = 1.0,
        rounding: Number = 0.1,
    ) -> None: ...

class Capsule(Shape):
    """Upright round bar with half balls at its ends."""

    def __init__(self, radius: Number = 0.4, height: Number = 1.0) -> None: ...

class CapsuleBetween(Shape):
    """Round bar between two points, with half balls at its ends."""

    def __init__(self, start: Vector = ..., end: Vector = ..., radius: Number = 0.4) -> None: ...

class MengerSponge(Shape):
    """Menger's sponge: a cube without its middle cross, and so on for the 20 cubes that are left."""

    def __init__(self, size: Number = 1.0, iterations: int = 4) -> None: ...

class Mandelbulb(Shape):
    """The Mandelbulb, around the y axis: points whose powers stay, in polar coordinates."""

    def __init__(self, power: int = 8, iterations: int = 8) -> None: ...

class QuaternionJulia(Shape):
    """A Julia set of quaternions, where their last part is 0."""

    def __init__(self, c: Vector = ..., iterations: int = 10) -> None: ...

class Mandelbox(Shape):
    """The Mandelbox: points whose foldings at a cube and a ball stay."""

    def __init__(self, size: Number = 1.5, scale: Number = 2.0, iterations: int = 8) -> None: ...

class Heightfield(Shape):
    """Terrain from an image of heights, in its first channel; its edges go on without end."""

    def __init__(
        self,
        image: Image = ...,
        size: Vector = ...,
        height: Number = 1.0,
        steepness: Number = 1.0,
    ) -> None: ...

class CubicLattice(Shape):
    """Struts along the edges of cubes, a node at the origin."""

    def __init__(self, cell_size: Number = 0.5, radius: Number = 0.06) -> None: ...

class BccLattice(Shape):
    """Struts from the corners of cubes to their middles (body-centred cubic)."""

    def __init__(self, cell_size: Number = 0.5, radius: Number = 0.05) -> None: ...

class FccLattice(Shape):
    """Struts from the corners of cubes to the middles of their faces (face-centred cubic)."""

    def __init__(self, cell_size: Number = 0.5, radius: Number = 0.05) -> None: ...

class OctetLattice(Shape):
    """The octet truss: the edges of octahedra and tetrahedra that fill space."""

    def __init__(self, cell_size: Number = 0.75, radius: Number = 0.05) -> None: ...

class Metaballs(Shape):
    """Balls that melt into each other; their order does not matter."""

    def __init__(self, balls: Points = ..., softness: Number = 0.1) -> None: ...

class OctahedronCheap(Shape):
    """Octahedron by its faces alone; beyond edges less than the distance."""

    def __init__(self, radius: Number = 1.0) -> None: ...

class Dodecahedron(Shape):
    """Regular body of twelve pentagons; beyond edges less than the distance."""

    def __init__(self, radius: Number = 1.0) -> None: ...

class Icosahedron(Shape):
    """Regular body of twenty triangles; beyond edges less than the distance."""

    def __init__(self, radius: Number = 1.0) -> None: ...

class TruncatedOctahedron(Shape):
    """Body of eight hexagons and six squares with equal edges; it fills space."""

    def __init__(self, radius: Number = 1.0) -> None: ...

class TruncatedIcosahedron(Shape):
    """Football: twenty hexagons and twelve pentagons with equal edges."""

    def __init__(self, radius: Number = 1.0) -> None: ...

class Octahedron(Shape):
    """Regular octahedron."""

    def __init__(self, radius: Number = 1.0) -> None: ...

class Tetrahedron(Shape):
    """Regular tetrahedron on every other corner of a cube, (1, 1, 1) among them."""

    def __init__(self, radius: Number = 1.0) -> None: ...

class Pyramid(Shape):
    """Upright pyramid over a square."""

    def __init__(self, size: Number = 1.0, height: Number = 1.0) -> None: ...

class ConvexPolyhedron(Shape):
    """What planes leave of a box; beyond edges less than the distance."""

    def __init__(self, planes: Points = ..., size: Vector = ...) -> None: ...

class TriPrism(Shape):
    """Upright prism over an equilateral triangle; one side looks along z."""

    def __init__(self, apothem: Number = 0.4, height: Number = 1.0) -> None: ...

class HexPrism(Shape):
    """Upright prism over a regular hexagon; one side looks along z."""

    def __init__(self, apothem: Number = 0.5, height: Number = 1.0) -> None: ...

class OctagonPrism(Shape):
    """Upright prism over a regular octagon; sides look along x and z."""

    def __init__(self, apothem: Number = 0.5, height: Number = 1.0) -> None: ...

class Prism(Shape):
    """Upright prism over a regular polygon; one side looks along z."""

    def __init__(self, count: int = 5, apothem: Number = 0.5, height: Number = 1.0) -> None: ...

class Rhombus(Shape):
    """Upright prism over a rhombus with rounded upright edges."""

    def __init__(
        self,
        diagonals: Vector = ...,
        height: Number = 1.0,
        rounding: Number = 0.05,
    ) -> None: ...

class CircleLine(Shape):
    """A circle without thickness around the y axis."""

    def __init__(self, radius: Number = 0.75) -> None: ...

class Disc(Shape):
    """A round plate without thickness around the y axis."""

    def __init__(self, radius: Number = 0.75) -> None: ...

class Torus(Shape):
    """Ring around the y axis."""

    def __init__(self, major: Number = 0.75, minor: Number = 0.25) -> None: ...

class CappedTorus(Shape):
    """Part of a ring around the y axis, with round ends, symmetric about the x axis."""

    def __init__(self, angle: Number = 2.0, major: Number = 0.75, minor: Number = 0.25) -> None: ...

class Link(Shape):
    """Link of a chain, upright, seen as a ring along the z axis."""

    def __init__(self, height: Number = 0.5, major: Number = 0.4, minor: Number = 0.15) -> None: ...

class Sphere(Shape):
    """Ball."""

    def __init__(self, radius: Number = 1.0) -> None: ...

class Ellipsoid(Shape):
    """Ellipsoid; outside a lower bound, close to the distance near the surface."""

    def __init__(self, radii: Vector = ...) -> None: ...

class Superellipsoid(Shape):
    """Between a diamond, a ball and a box, by two exponents; a bound with slope 1."""

    def __init__(self, radii: Vector = ..., across: Number = 4.0, upward: Number = 4.0) -> None: ...

class Blob(Shape):
    """Ball with twelve round bumps, towards the vertices of an icosahedron."""

    def __init__(self, radius: Number = 0.75, height: Number = 0.2) -> None: ...

class SmoothOctahedron(Shape):
    """Between a ball and an octahedron; a bound with slope 1."""

    def __init__(self, radius: Number = 0.6, exponent: Number = 12.0) -> None: ...

class SmoothDodecahedron(Shape):
    """Between a ball and a dodecahedron; a bound with slope 1."""

    def __init__(self, radius: Number = 0.8, exponent: Number = 24.0) -> None: ...

class SmoothIcosahedron(Shape):
    """Between a ball and an icosahedron; a bound with slope 1."""

    def __init__(self, radius: Number = 0.8, exponent: Number = 24.0) -> None: ...

class SmoothTruncatedOctahedron(Shape):
    """Between a ball and a truncated octahedron; a bound with slope 1."""

    def __init__(self, radius: Number = 0.8, exponent: Number = 24.0) -> None: ...

class SmoothTruncatedIcosahedron(Shape):
    """Between a ball and a football; a bound with slope 1."""

    def __init__(self, radius: Number = 0.9, exponent: Number = 48.0) -> None: ...

class Plane(Shape):
    """Ground: everything up to a height."""

    def __init__(self, y: Number = 0.0) -> None: ...

class HalfSpace(Shape):
    """Everything behind a plane."""

    def __init__(self, normal: Vector = ..., offset: Number = 0.0) -> None: ...

class Slab(Shape):
    """Level slab without end, half of it above the origin."""

    def __init__(self, thickness: Number = 0.5) -> None: ...

class Wedge(Shape):
    """What lies between two planes that meet in the z axis, around the way down; without end."""

    def __init__(self, angle: Number = 1.0) -> None: ...

class Triangle(Shape):
    """Flat triangle without thickness."""

    def __init__(self, a: Vector = ..., b: Vector = ..., c: Vector = ...) -> None: ...

class Quad(Shape):
    """Face with four corners, without thickness: the triangles a, b, c and a, c, d."""

    def __init__(
        self,
        a: Vector = ...,
        b: Vector = ...,
        c: Vector = ...,
        d: Vector = ...,
    ) -> None: ...

class Gyroid(Shape):
    """Schoen's gyroid: no straight lines, no mirrors, two mazes that never meet."""

    def __init__(
        self,
        cell_size: Number = 1.0,
        thickness: Number = 0.1,
        offset: Number = 0.0,
        solid: bool = False,
    ) -> None: ...

class SchwarzP(Shape):
    """Schwarz's primitive surface: tubes along the axes that meet in every cell's middle."""

    def __init__(
        self,
        cell_size: Number = 1.0,
        thickness: Number = 0.1,
        offset: Number = 0.0,
        solid: bool = False,
    ) -> None: ...

class Diamond(Shape):
    """Schwarz's diamond surface: tubes along the bonds of a diamond's atoms."""

    def __init__(
        self,
        cell_size: Number = 1.0,
        thickness: Number = 0.1,
        offset: Number = 0.0,
        solid: bool = False,
    ) -> None: ...

class Neovius(Shape):
    """Neovius' surface: as Schwarz's primitive one, with tubes along the edges too."""

    def __init__(
        self,
        cell_size: Number = 1.0,
        thickness: Number = 0.1,
        offset: Number = 0.0,
        solid: bool = False,
    ) -> None: ...

class Lidinoid(Shape):
    """Lidin's surface, a twisted kin of the gyroid."""

    def __init__(
        self,
        cell_size: Number = 1.0,
        thickness: Number = 0.1,
        offset: Number = 0.0,
        solid: bool = False,
    ) -> None: ...

class SplitP(Shape):
    """A surface between the gyroid and Schwarz's primitive one."""

    def __init__(
        self,
        cell_size: Number = 1.0,
        thickness: Number = 0.1,
        offset: Number = 0.0,
        solid: bool = False,
    ) -> None: ...

class IWP(Shape):
    """Schoen's I-WP surface: tubes along the diagonals of a cube."""

    def __init__(
        self,
        cell_size: Number = 1.0,
        thickness: Number = 0.1,
        offset: Number = 0.0,
        solid: bool = False,
    ) -> None: ...

class PolylineTube(Shape):
    """A round tube through points, straight between them."""

    def __init__(
        self,
        points: Points = ...,
        radius: Number = 0.1,
        closed: bool = False,
    ) -> None: ...

class TaperedPolylineTube(Shape):
    """A round tube through points, with a radius for each: branches, tentacles."""

    def __init__(self, points: Points = ...) -> None: ...

class BezierTube(Shape):
    """A round tube along a quadratic Bézier curve."""

    def __init__(
        self,
        start: Vector = ...,
        control: Vector = ...,
        end: Vector = ...,
        radius: Number = 0.1,
    ) -> None: ...

class CubicBezierTube(Shape):
    """A round tube along a cubic Bézier curve, its radius changing evenly; made of straight pieces."""

    def __init__(
        self,
        start: Vector = ...,
        leaving: Vector = ...,
        arriving: Vector = ...,
        end: Vector = ...,
        start_radius: Number = 0.12,
        end_radius: Number = 0.06,
        pieces: int = 16,
    ) -> None: ...

class TaperedBezierTube(Shape):
    """A round tube along a quadratic Bézier curve, its radius changing evenly; straight pieces."""

    def __init__(
        self,
        start: Vector = ...,
        control: Vector = ...,
        end: Vector = ...,
        start_radius: Number = 0.12,
        end_radius: Number = 0.06,
        pieces: int = 16,
    ) -> None: ...

class VolumeField(Shape):
    """A shape whose distances are the samples of a grid, in their first channel."""

    def __init__(self, volume: Image = ..., size: Vector = ..., scale: Number = 1.0) -> None: ...

CLASSES: dict[str, type[Shape] | type[Shape2D]]

__all__ = [
    "IWP",
    "Annulus",
    "Arc",
    "ArcCam",
    "ArchimedeanSpiral",
    "BccLattice",
    "BezierTube",
    "Blob",
    "BlobbyCross",
    "Box",
    "BoxCheap",
    "BoxFrame",
    "CappedCone",
    "CappedConeBetween",
    "CappedTorus",
    "Capsule",
    "CapsuleBetween",
    "ChamferBox",
    "ChamferedRectangle",
    "Circle",
    "CircleCross",
    "CircleLine",
    "CircleWave",
    "Cone",
    "ConeBetween",
    "ConeCheap",
    "ConvexPolyhedron",
    "CoolS",
    "Corner",
    "Cross",
    "CubicBezier",
    "CubicBezierTube",
    "CubicLattice",
    "CutDisk",
    "CutHollowSphere",
    "CutSphere",
    "Cylinder",
    "CylinderBetween",
    "DeathStar",
    "Diamond",
    "Disc",
    "Dodecahedron",
    "Egg",
    "Ellipse",
    "Ellipsoid",
    "EquilateralTriangle",
    "FbmSolid",
    "FccLattice",
    "GearProfile",
    "GradientNoiseSolid",
    "Gyroid",
    "HalfPlane",
    "HalfSpace",
    "Heart",
    "Heightfield",
    "Helix",
    "HexPrism",
    "Hexagon",
    "Hexagram",
    "Horseshoe",
    "Hyperbola",
    "Icosahedron",
    "ImageField",
    "InfiniteCone",
    "InfiniteCylinder",
    "IsoscelesTrapezoid",
    "IsoscelesTriangle",
    "Lidinoid",
    "Link",
    "LogarithmicSpiral",
    "Mandelbox",
    "Mandelbulb",
    "MengerSponge",
    "Metaballs",
    "Moon",
    "Neovius",
    "Octagon",
    "OctagonPrism",
    "Octahedron",
    "OctahedronCheap",
    "OctetLattice",
    "OrientedRectangle",
    "OrientedVesica",
    "Parabola",
    "ParabolaSegment",
    "Parallelogram",
    "Pentagon",
    "Pentagram",
    "Pie",
    "Plane",
    "Polygon",
    "Polyline",
    "PolylineTube",
    "Prism",
    "Pyramid",
    "Quad",
    "QuadraticBezier",
    "QuadraticCircle",
    "QuaternionJulia",
    "Rectangle",
    "RegularPolygon",
    "RegularStar",
    "Rhombus",
    "Rhombus2",
    "Ring",
    "RoundBox",
    "RoundCone",
    "RoundConeBetween",
    "RoundFrame",
    "RoundedCylinder",
    "RoundedPolygon",
    "RoundedRectangle",
    "RoundedX",
    "ScatteredBalls",
    "SchwarzP",
    "Segment",
    "SimplexNoiseSolid",
    "Slab",
    "SmoothDodecahedron",
    "SmoothIcosahedron",
    "SmoothOctahedron",
    "SmoothTruncatedIcosahedron",
    "SmoothTruncatedOctahedron",
    "SolidAngle",
    "Sphere",
    "SplinePath",
    "SplitP",
    "Spring",
    "Stairs",
    "Superellipsoid",
    "TangentCam",
    "TaperedBezierTube",
    "TaperedPolylineTube",
    "Tetrahedron",
    "Torus",
    "TriPrism",
    "Triangle",
    "Triangle2",
    "TruncatedIcosahedron",
    "TruncatedOctahedron",
    "Tunnel",
    "UnevenCapsule",
    "ValueNoiseSolid",
    "Vesica",
    "VesicaBetween",
    "VesicaSolid",
    "VolumeField",
    "VoronoiCells",
    "VoronoiLines",
    "VoronoiWalls",
    "Wedge",
]
