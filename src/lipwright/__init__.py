"""Speech in, natural facial animation out, on any character."""
