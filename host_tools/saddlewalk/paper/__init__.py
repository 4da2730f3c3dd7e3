"""The results of the paper (README, "What is from the paper"), reproduced from the C core."""
