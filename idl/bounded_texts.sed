# The generated code allocates the number of texts that a message announces before it reads one, so a message of 100 bytes could use up all memory.
# 4096 is above the bound of every sequence of texts.
s/^\( *\)\(m_[a-z]*.resize(sequence_size);\)/\1if (sequence_size > 4096) throw BadParamException("a sequence is too long");\n\1\2/
