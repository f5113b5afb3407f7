#include "core/protocol/families/registry.hpp"

#include <algorithm>
#include <array>

#include "core/protocol/allen_bradley_df1/allen_bradley_df1.hpp"
#include "core/protocol/dtc/dtc.hpp"
#include "core/protocol/mitsubishi_fx/mitsubishi_fx.hpp"
#include "core/protocol/mitsubishi_mc/mitsubishi_mc.hpp"
#include "core/protocol/mitsubishi_mc_serial/mitsubishi_mc_serial.hpp"
#include "core/protocol/modbus/modbus.hpp"
#include "core/protocol/omron_fins/fins_tcp.hpp"
#include "core/protocol/omron_hostlink/omron_hostlink.hpp"
#include "core/protocol/s7_freeport/s7_freeport.hpp"
#include "core/protocol/s7_ppi/s7_ppi.hpp"
#include "core/protocol/s7_tcp/s7_tcp.hpp"

namespace fieldcast {

std::span<const ProtocolEntry> protocols() {
  // A new family adds its rows here.
  // clang-format off
  static const std::array entries{
      df1::entry(),
      dtc::entry(),
      mitsubishi_fx::entry(),
      mitsubishi_mc::entry(),
      mitsubishi_mc::serial_entry(),
      modbus::rtu_entry(),
      modbus::ascii_entry(),
      modbus::tcp_entry(),
      omron::fins_tcp_entry(),
      omron::hostlink_entry(),
      s7_freeport::entry(),
      s7_ppi::entry(),
      s7_tcp::entry(),
  };
  // clang-format on
  return entries;
}

const ProtocolEntry* find_protocol(std::string_view name) {
  const auto all = protocols();
  const auto found =
      std::ranges::find_if(all, [&](const ProtocolEntry& entry) { return entry.name == name; });
  return found == all.end() ? nullptr : &*found;
}

DeviceLink link_of(const ProtocolVariant& variant, std::uint16_t address) {
  DeviceLink link{.address = address};
  for (const auto& [name, value] : variant.options) link.options.emplace(name, value);
  return link;
}

}  // namespace fieldcast
