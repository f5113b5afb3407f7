#include <algorithm>
#include <array>

#include "tools/sim/device/declared_device.hpp"
#include "tools/sim/device/device.hpp"
#include "tools/sim/families/df1_device.hpp"
#include "tools/sim/families/dtc_device.hpp"
#include "tools/sim/families/fins_tcp_device.hpp"
#include "tools/sim/families/fins_unit.hpp"
#include "tools/sim/families/freeport_device.hpp"
#include "tools/sim/families/fx_device.hpp"
#include "tools/sim/families/hostlink_device.hpp"
#include "tools/sim/families/mc_device.hpp"
#include "tools/sim/families/mc_serial_device.hpp"
#include "tools/sim/families/modbus/modbus_device.hpp"
#include "tools/sim/families/modbus/modbus_unit.hpp"
#include "tools/sim/families/ppi_device.hpp"
#include "tools/sim/families/s7_tcp_device.hpp"

namespace fieldcast::sim {

std::span<const DeviceKind> device_kinds() {
  static const std::array kinds{
      DeviceKind{"modbus-rtu", kModbusAreaNames, true, &make_modbus_rtu_device},
      DeviceKind{"modbus-ascii", kModbusAreaNames, true, &make_modbus_ascii_device},
      DeviceKind{"modbus-tcp", kModbusAreaNames, false, &make_modbus_tcp_device},
      DeviceKind{"allen-bradley-df1", kDf1AreaNames, false, &make_df1_device},
      DeviceKind{"dtc", kDtcAreaNames, true, &make_dtc_device},
      DeviceKind{"mitsubishi-fx", kFxAreaNames, true, &make_fx_device},
      DeviceKind{"mitsubishi-mc", kMcAreaNames, false, &make_mc_device},
      DeviceKind{"mitsubishi-mc-serial", kMcAreaNames, true, &make_mc_serial_device},
      DeviceKind{"omron-fins", kOmronAreaNames, false, &make_fins_tcp_device},
      DeviceKind{"omron-hostlink", kOmronAreaNames, true, &make_hostlink_device},
      DeviceKind{"s7-freeport", kFreeportAreaNames, true, &make_freeport_device},
      DeviceKind{"s7-ppi", kPpiAreaNames, true, &make_ppi_device},
      DeviceKind{"s7-tcp", kS7TcpAreaNames, false, &make_s7_tcp_device},
  };
  return kinds;
}

const DeviceKind* find_device_kind(std::string_view protocol) {
  const auto kinds = device_kinds();
  const auto found = std::ranges::find(kinds, protocol, &DeviceKind::protocol);
  return found == kinds.end() ? nullptr : &*found;
}

const DeviceKind* kind_of(const DeviceSpec& device) {
  static const DeviceKind declared{"", {}, true, &make_declared_device};
  return device.declaration ? &declared : find_device_kind(device.protocol);
}

std::vector<std::string_view> area_names(const DeviceSpec& device) {
  if (device.declaration) return declared_area_names(*device.declaration.value);
  const DeviceKind* kind = find_device_kind(device.protocol);
  if (kind == nullptr) return {};
  return {kind->areas.begin(), kind->areas.end()};
}

}  // namespace fieldcast::sim
