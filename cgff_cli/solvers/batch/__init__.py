"""Many structures of one topology side by side: their columns, their lines, the signs of their stiffness."""
