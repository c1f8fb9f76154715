"""Reads the XML of a 3MF model while it is unpacked; what is not used is not kept.

Input: chunks of bytes. Output: a ``Model``: its objects, colors and what its build names. Sizes are
counted as elements come; a document type is refused by the parser's own event, whatever the
encoding.

Source: 3MF Core Specification 1.3; Production Extension 1.1; Materials Extension 1.2.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, Final
from xml.parsers import expat

from distal.diagnostics import LoadError, printable
from distal.foreign_files import check_time
from distal.polygons.triangles import PART_BYTES, MeshSize

_CORE: Final = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
_PATH: Final = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06}path"
_MATERIAL: Final = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02}"
_RELATIONS: Final = "http://schemas.openxmlformats.org/package/2006/relationships}"
_GROUPS: Final = {f"{_MATERIAL}colorgroup", f"{_CORE}basematerials"}
_COLORS: Final = {f"{_MATERIAL}color": "color", f"{_CORE}base": "displaycolor"}
_DEEPEST: Final = 100  # elements within elements
_LOOK: Final = 2**14  # elements between two looks at the sizes
_REQUIRED: Final = "requiredextensions"
# Namespaces that a model may require: what they add to a mesh is read, or is no part of its shape.
_READ: Final = {
    _CORE[:-1],
    _PATH.partition("}")[0],
    _MATERIAL[:-1],
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
}
_BEAMS: Final = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02}beamlattice"
_KEPT_BYTES: Final = 1024  # of an element whose attributes are kept
_LONGEST: Final = 2**20  # bytes of a tag: expat keeps all of one

Attributes = dict[str, str]


@dataclass(slots=True)
class ModelObject:
    """An object as it is written.

    Attributes:
        attributes: Those of its element.
        points: Coordinates, one after the other.
        corners: Numbers of points, one after the other.
        colors: For each triangle the attributes pid, p1, p2 and p3; empty without colors.
        components: Attributes of each component.
        is_mesh: Whether it has a mesh.
        has_beams: Whether it has a lattice of beams.
    """

    attributes: Attributes
    points: array[float] = field(default_factory=lambda: array("d"))
    corners: array[int] = field(default_factory=lambda: array("q"))
    colors: list[tuple[str | None, ...]] = field(default_factory=list)
    components: list[Attributes] = field(default_factory=list)
    is_mesh: bool = False
    has_beams: bool = False


@dataclass(slots=True)
class Model:
    """What a model's file holds.

    Attributes:
        attributes: Those of its root.
        objects: The objects.
        items: Attributes of each item of the build.
        palettes: The texts of the colors of each group, by its id.
        relations: Attributes of each relation, if it is a list of relations.
    """

    attributes: Attributes = field(default_factory=dict)
    objects: list[ModelObject] = field(default_factory=list)
    items: list[Attributes] = field(default_factory=list)
    palettes: dict[str, list[str]] = field(default_factory=dict)
    relations: list[Attributes] = field(default_factory=list)


def path_of(attributes: Attributes) -> str | None:
    """Return the part of the archive that a component or an item names."""
    return attributes.get(_PATH)


class _Elements:
    """Makes a model of the events of a parser.

    Attributes:
        model: What came so far.
    """

    def __init__(self, size: MeshSize, line: Callable[[], int], *, with_colors: bool) -> None:
        self.model = Model()
        self._line = line
        self._spaces: dict[str, str] = {}
        self._size, self._with_colors = size, with_colors
        self._path: list[str] = []
        self._object: ModelObject | None = None
        self._palette: list[str] = []
        # Elements that were taken, and which of them are points and triangles of earlier objects.
        self._count = self._numbers = 0
        self._starts: dict[str, Callable[[Attributes], None]] = {
            f"{_CORE}vertex": self._vertex,
            f"{_CORE}triangle": self._triangle,
            f"{_CORE}mesh": self._mesh,
            _BEAMS: self._beams,
            f"{_CORE}component": self._component,
            f"{_CORE}object": self._new_object,
            f"{_CORE}item": self.model.items.append,
            f"{_RELATIONS}Relationship": self.model.relations.append,
        }
        if with_colors:
            self._starts |= dict.fromkeys(_GROUPS, self._group)
            self._starts |= {name: self._color(key) for name, key in _COLORS.items()}

    def start(self, name: str, attributes: Attributes) -> None:
        """An element begins."""
        if not self._path:
            self.model.attributes = attributes
            self._check_required(attributes.get(_REQUIRED, ""))
        if len(self._path) >= _DEEPEST:
            raise LoadError(f"its elements are more than {_DEEPEST} deep")
        self._path.append(name)
        take = self._starts.get(name)
        if take is not None:
            take(attributes)
            self._count += 1
            if self._count % _LOOK == 0:
                self.check()

    def space(self, prefix: str | None, address: str) -> None:
        """A namespace begins."""
        self._spaces.setdefault(prefix or "", address)

    def end(self, name: str) -> None:
        """An element ends."""
        self._path.pop()
        if name == f"{_CORE}object":
            self._object = None

    def doctype(self, *_: Any) -> None:
        """A document type begins: entities could unpack to any length."""
        raise LoadError("it declares a document type, which 3MF forbids")

    def check(self) -> None:
        """Check the sizes so far."""
        numbers = sum(len(o.points) + len(o.corners) for o in self.model.objects[-1:]) // 3
        kept = self._count - self._numbers - numbers
        size = replace(self._size, parts=self._size.parts + kept * _KEPT_BYTES // PART_BYTES)
        for each in self.model.objects[-1:]:
            size.add(MeshSize(len(each.points) // 3, len(each.corners) // 3, 0))
        size.check()

    def _new_object(self, attributes: Attributes) -> None:
        for each in self.model.objects[-1:]:
            points, triangles = len(each.points) // 3, len(each.corners) // 3
            self._size.add(MeshSize(points, triangles, 0))
            self._numbers += points + triangles
        self._object = ModelObject(attributes)
        self.model.objects.append(self._object)

    def _check_required(self, prefixes: str) -> None:
        for prefix in prefixes.split():
            address = self._spaces.get(prefix, prefix)
            if address not in _READ:
                raise LoadError(
                    f"it requires the extension {printable(address, 100)}, which is not read: "
                    "save it without"
                )

    def _beams(self, _: Attributes) -> None:
        if self._object is not None:
            self._object.has_beams = True

    def _mesh(self, _: Attributes) -> None:
        if self._object is not None:
            self._object.is_mesh = True

    def _vertex(self, attributes: Attributes) -> None:
        if self._object is not None:
            try:
                row = [float(attributes[name]) for name in "xyz"]
            except (KeyError, ValueError):
                raise self._wrong("vertex", "xyz", attributes) from None
            if any("_" in attributes[name] for name in "xyz"):  # as Python writes numbers
                raise self._wrong("vertex", "xyz", attributes)
            self._object.points.extend(row)

    def _triangle(self, attributes: Attributes) -> None:
        if self._object is None:
            return
        names = ("v1", "v2", "v3")
        try:
            self._object.corners.extend([int(attributes[name]) for name in names])
        except (KeyError, ValueError, OverflowError):
            raise self._wrong("triangle", names, attributes) from None
        if self._with_colors:
            get = attributes.get
            self._object.colors.append((get("pid"), get("p1"), get("p2"), get("p3")))

    def _wrong(self, what: str, names: Iterable[str], attributes: Attributes) -> LoadError:
        shown = " ".join(f"{n}={attributes[n]!r:.20}" for n in names if n in attributes)
        need = ", ".join(names)
        return LoadError(
            f"line {self._line()} of its model: a {what} has no numbers {need}"
            + (f": {printable(shown)}" if shown else "")
        )

    def _component(self, attributes: Attributes) -> None:
        if self._object is not None:
            self._object.components.append(attributes)

    def _group(self, attributes: Attributes) -> None:
        self._palette = self.model.palettes[attributes.get("id", "")] = []

    def _color(self, key: str) -> Callable[[Attributes], None]:
        return lambda attributes: self._palette.append(attributes.get(key, ""))


def read_model(chunks: Iterable[bytes], size: MeshSize, *, with_colors: bool) -> Model:
    """Return what a model's file holds.

    Args:
        chunks: The file's bytes.
        size: What other models of the archive have; that of this one is added.
        with_colors: Whether colors are wanted.

    Raises:
        LoadError: It is no XML, has a document type, or is larger than the file may become.
    """
    parser = expat.ParserCreate(namespace_separator="}")
    elements = _Elements(size, lambda: parser.CurrentLineNumber, with_colors=with_colors)
    parser.StartNamespaceDeclHandler = elements.space
    parser.StartElementHandler = elements.start
    parser.EndElementHandler = elements.end
    parser.StartDoctypeDeclHandler = elements.doctype
    fed = 0
    try:
        for chunk in chunks:
            parser.Parse(chunk, False)
            fed += len(chunk)
            if fed - parser.CurrentByteIndex > _LONGEST:
                raise LoadError(f"a tag of it is longer than {_LONGEST >> 20} MiB")
            check_time()
        parser.Parse(b"", True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise LoadError(f"it is no XML: {error}") from None
    elements.check()
    return elements.model
