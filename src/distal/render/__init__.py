"""How a field becomes a picture: cameras, marchers, lights, materials, views; all scene code."""
