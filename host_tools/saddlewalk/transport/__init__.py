"""CAN and LCM: frames, messages and transports."""
