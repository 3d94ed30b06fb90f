"""What a run found: its history, checkpoints, derived figures and summary."""
