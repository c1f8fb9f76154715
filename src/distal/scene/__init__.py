"""Scene objects (shapes, materials, lights, cameras) and their lowering to IR."""
