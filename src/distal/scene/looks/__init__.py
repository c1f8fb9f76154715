"""Looks: light, backdrop, camera and floor of a scene by one word."""
