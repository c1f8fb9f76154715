"""The runtime: runs scene functions and pictures on a device, with Python arguments and results."""
