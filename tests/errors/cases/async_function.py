from distal.lang import func


@func
async def scene(x: float) -> float:
    return x
