"""What the supervisor is worth: emulated falls, recorded people, the claims of the model."""
