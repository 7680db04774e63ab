"""Axes of a tmcld as actuators of PyMoDAQ: docs/bridges/pymodaq.md."""
