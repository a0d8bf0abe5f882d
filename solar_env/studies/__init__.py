"""Studies of speed, accuracy and stability: each measures, writes a table, and draws figures from the table alone."""
