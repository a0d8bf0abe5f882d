"""Studies of speed, accuracy, stability and design: each measures, writes a table, and draws from that table alone.

A study is a folder with modules that measure and draw, a page `README.md` with the results, and `figures` beside
it; its command is in `solar_env.commands`. `common` holds shared parts, `peers` the programs compared with;
`precision` knows the methods by name. Studies import everything below and may import these three, but no other study.
"""
