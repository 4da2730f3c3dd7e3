"""How well the supervisor predicts falls: emulated and recorded walkers, claims of the model."""
