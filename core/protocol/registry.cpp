// The protocols that are built in. A new family adds its line here.
#include <algorithm>
#include <array>

#include "core/protocol/dtc/dtc.hpp"
#include "core/protocol/mitsubishi_fx/mitsubishi_fx.hpp"
#include "core/protocol/modbus/modbus.hpp"
#include "core/protocol/omron_hostlink/omron_hostlink.hpp"
#include "core/protocol/protocol.hpp"
#include "core/protocol/s7_freeport/s7_freeport.hpp"
#include "core/protocol/s7_ppi/s7_ppi.hpp"

namespace fieldcast {

std::span<const ProtocolEntry> protocols() {
  // clang-format off
  static const std::array entries{
      dtc::entry(),
      mitsubishi_fx::entry(),
      modbus::rtu_entry(),
      modbus::ascii_entry(),
      modbus::tcp_entry(),
      omron::hostlink_entry(),
      s7_freeport::entry(),
      s7_ppi::entry(),
  };
  // clang-format on
  return entries;
}

// Eight bits, since no number on the wire has fewer: a narrow one comes round while it is owed.
bool Protocol::mistakable(const Request&, ExchangeContext earlier, const Request&,
                          ExchangeContext later) const {
  return traits().identity != AnswerIdentity::kSequence ||
         (earlier.sequence & 0xFF) == (later.sequence & 0xFF);
}

const ProtocolEntry* find_protocol(std::string_view name) {
  const auto all = protocols();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const ProtocolEntry& entry) { return entry.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace fieldcast
