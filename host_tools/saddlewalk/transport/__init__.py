"""CAN and LCM: frames, messages, and the ways that they go."""
