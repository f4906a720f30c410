"""Effects that a nominal model leaves out: what each is, how it edits the model, what instruments make of it."""
