"""How well the supervisor predicts falls, and whether the model's claims hold."""
