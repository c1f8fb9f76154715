"""distal: 3D scenes written as Python functions, seen everywhere."""
