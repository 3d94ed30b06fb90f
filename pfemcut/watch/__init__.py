"""Following a run from outside: a local page and a view for terminals, both made from the output directory alone."""
