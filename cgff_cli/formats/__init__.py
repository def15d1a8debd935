"""Files of other programs: a scene out of each, and each out of a scene. A format is a file or two."""
