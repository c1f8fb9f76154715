"""A picture that moves, for every test of sequences."""

import pytest

import distal
from tests.video.moving import scene_file


@pytest.fixture
def moving(tmp_path):
    return distal.load(str(scene_file(tmp_path)))
