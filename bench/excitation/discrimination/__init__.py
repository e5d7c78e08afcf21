"""Which motion would tell two physical effects apart: designed, judged in nats, written for a controller."""
