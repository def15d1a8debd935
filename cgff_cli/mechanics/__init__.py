"""Third room: the physics, as pure functions of arrays."""
