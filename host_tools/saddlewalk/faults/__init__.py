"""A bus that misbehaves: scenarios, campaigns, and what counts as unsafe."""
