"""The studio's worker: author code to programs, numbers and places, by JSON messages."""
