"""Specialise: functions bound to the functions, textures and constants they are passed."""
