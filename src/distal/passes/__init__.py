"""Passes from IR to IR. One file, one pass, one public function ``run(module, context)``.

``pipeline`` lists them in the order they run.
"""
