"""Tables: large arrays of constants stored in buffers."""
