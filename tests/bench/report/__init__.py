"""Rounds of measuring programs, what they amount to, and a page of it."""
