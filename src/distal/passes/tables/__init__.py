"""Tables: store large arrays of constants in buffers."""
