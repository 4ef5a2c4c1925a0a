"""Results with an estimated error of each output. Nothing else in the library imports this."""
