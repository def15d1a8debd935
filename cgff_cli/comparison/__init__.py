"""One scene by several methods, laid over each other and timed."""
