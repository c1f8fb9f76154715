"""Scene objects stay as they were made: copies are themselves, and none leaves its process."""

from __future__ import annotations

import copy
import pickle

import pytest

from distal import Camera, PointLight, Scene, Sky, Sphere, checker, glass, time
from distal.lang import slider

OBJECTS = [
    Sphere(),
    Scene(Sphere()),
    Camera(),
    PointLight((1, 2, 3)),
    Sky(),
    glass(),
    checker(),
    slider("Radius", 0.5),
    0.5 * time,
]


@pytest.mark.parametrize("made", OBJECTS, ids=lambda made: type(made).__name__)
def test_copies_are_the_same_object(made):
    assert copy.copy(made) is made
    assert copy.deepcopy([made])[0] is made


@pytest.mark.parametrize("made", OBJECTS, ids=lambda made: type(made).__name__)
def test_pickling_is_refused_with_what_to_do_instead(made):
    with pytest.raises(TypeError, match="make it again in the other process"):
        pickle.dumps(made)
