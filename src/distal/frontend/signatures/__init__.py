"""What annotations mean, and what the ``def`` line of a function declares."""
