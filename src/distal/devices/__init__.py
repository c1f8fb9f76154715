"""The devices that run compiled scenes; each returns a ``base.Kernel``."""
