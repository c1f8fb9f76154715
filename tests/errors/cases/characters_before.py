from distal.lang import func


@func
def scene(größe: float) -> float:
    ä = größe * größe
    return ä + größ
