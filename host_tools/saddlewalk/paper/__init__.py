"""The results of the paper (docs/paper.md), reproduced from the C core."""
