"""The parts of ``make site``: playground, lessons, gallery, documents, search."""
