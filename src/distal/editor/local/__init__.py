"""``distal studio``: the editor's app, served to a browser on the same machine."""
