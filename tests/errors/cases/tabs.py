from distal.lang import func


@func
def scene(x: float) -> float:
	if x > 0.0:
		return x + undefined_name
	return x
