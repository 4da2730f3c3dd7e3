"""A body with segments, contacts and torque limits, moved by MuJoCo, that walks by the plan."""
