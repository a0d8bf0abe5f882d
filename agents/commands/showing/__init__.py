"""What `solar-env replay` makes of an episode: a page in motion, a film."""
