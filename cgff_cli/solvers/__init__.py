"""Fourth room: from a start shape to an equilibrium, and an honest word on what was reached."""
