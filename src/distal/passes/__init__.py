"""Passes that transform the IR. Each is one file with one public function ``run(module, context)``.

``pipeline`` lists them in the order in which they run.
"""
