"""Planning time of the core, compared with other planners."""
