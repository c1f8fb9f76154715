from distal.lang import func

scene = func(lambda x: x)
