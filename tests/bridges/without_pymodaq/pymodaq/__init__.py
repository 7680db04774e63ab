"""Stands in for PyMoDAQ, which Debian has not: what a plugin of an actuator is made of."""
