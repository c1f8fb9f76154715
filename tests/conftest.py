"""What every test runs under."""

import os

# Each pass's output is held against the IR's rules; read when distal.compiler is imported.
os.environ.setdefault("DISTAL_VERIFY", "1")
