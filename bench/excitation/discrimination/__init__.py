"""The motion that distinguishes two physical effects: designed, judged in nats, written for a controller."""
