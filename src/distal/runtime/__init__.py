"""The runtime: calls of scene functions and pictures, from Python values to a device and back."""
