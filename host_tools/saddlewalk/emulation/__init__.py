"""The emulated wearer and exoskeleton, and the firmware that they walk with."""
