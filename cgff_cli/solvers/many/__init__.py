"""Many structures of one topology at once."""
