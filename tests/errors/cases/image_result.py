from distal.lang import (Frame, image)


@image
def scene(frame: Frame) -> float:
    return frame.time
