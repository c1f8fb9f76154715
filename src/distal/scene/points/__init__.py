"""Points along curves, on surfaces and in volumes, for arrays of shapes."""
