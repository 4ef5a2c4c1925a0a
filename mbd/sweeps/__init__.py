"""One scene for many parameters, on as many processors as there are. Nothing else in the library imports this."""
