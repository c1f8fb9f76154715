"""What leaves the machine: a page that shows a scene by itself, and shaders for other places."""
