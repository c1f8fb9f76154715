"""Random numbers for paths: well distributed points, and directions made of them."""
