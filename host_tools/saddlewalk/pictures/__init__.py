"""Pictures of a walk."""
