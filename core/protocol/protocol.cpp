#include "core/protocol/protocol.hpp"

namespace fieldcast {

// Eight bits, since no number on the wire has fewer: a narrow one comes round while it is owed.
bool Protocol::mistakable(const Request&, ExchangeContext earlier, const Request&,
                          ExchangeContext later) const {
  return traits().identity != AnswerIdentity::kSequence ||
         (earlier.sequence & 0xFF) == (later.sequence & 0xFF);
}

}  // namespace fieldcast
