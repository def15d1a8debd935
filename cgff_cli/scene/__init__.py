"""First room: what the user wrote, read and checked."""
