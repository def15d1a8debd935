"""Fifth room: what kind of equilibrium was found."""
