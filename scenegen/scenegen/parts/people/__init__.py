"""People: bodies with limbs, bare skin and clothing, in several postures."""
