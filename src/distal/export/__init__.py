"""Export: pages that show a scene without distal, and shaders for other programs."""
