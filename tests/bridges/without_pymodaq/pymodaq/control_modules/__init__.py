"""See move_utility_classes."""
