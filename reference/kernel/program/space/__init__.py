"""Three dimensions, component by component."""
