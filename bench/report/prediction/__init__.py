"""What `bench predict` says and writes: terminal, page, prediction.json, recordings."""
