"""What is said before a run: its description, its cost, and a choice of its settings for an error or a time."""
