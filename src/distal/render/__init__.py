"""Rendering in scene code: cameras, ray marching, lights, materials, views."""
