"""Where compiled scenes run. ``base.Kernel`` is what each device gives back."""
