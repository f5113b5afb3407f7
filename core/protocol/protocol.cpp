#include "core/protocol/protocol.hpp"

namespace fieldcast {

// A number of eight bits, the narrowest of all families, may repeat while a response is pending.
bool Protocol::mistakable(const Request&, ExchangeContext earlier, const Request&,
                          ExchangeContext later) const {
  return traits().identity != ResponseIdentity::kSequence ||
         (earlier.sequence & 0xFF) == (later.sequence & 0xFF);
}

UnsolicitedFrame Protocol::find_unsolicited(ByteView bytes, bool) const {
  return {.used = bytes.size()};
}

std::string address_text(const DeviceLink& link) {
  return link.long_address.empty() ? std::to_string(link.address) : link.long_address;
}

}  // namespace fieldcast
