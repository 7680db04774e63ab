"""Stands in for qtpy, as far as the page of PyMoDAQ asks for it."""
