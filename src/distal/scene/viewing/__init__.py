"""One interface to everything that can be viewed, and how a person moves its camera."""
