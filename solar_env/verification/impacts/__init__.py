"""Single impacts, lasting contacts and stops against closed forms; may import everything but commands."""
