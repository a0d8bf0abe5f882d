"""Commands that show an episode of controllers: as a film, on a page in motion, as a figure; as those of `commands`."""
