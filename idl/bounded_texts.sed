# The generated code makes room for as many texts as a message says, before it reads one: a message of 100 bytes could take all memory.
# 4096 is more than any sequence of texts may have.
s/^\( *\)\(m_[a-z]*.resize(sequence_size);\)/\1if (sequence_size > 4096) throw BadParamException("a sequence is too long");\n\1\2/
