"""Lower statements and expressions of scene code to the IR."""
