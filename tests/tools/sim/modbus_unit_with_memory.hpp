#pragma once

#include "tests/tools/sim/listen.hpp"
#include "tools/sim/families/modbus/modbus_unit.hpp"

namespace fieldcast::sim {

struct ModbusUnitMemory {
  ItemMemory memory;
  DeviceStatistics counters;
};

// A unit that owns its memory; its waveforms begin at test::kBegin.
struct ModbusUnitWithMemory : ModbusUnitMemory, ModbusUnit {
  explicit ModbusUnitWithMemory(std::uint8_t address, DeviceSetup setup = {})
      : ModbusUnitMemory{{modbus_areas(), begun(std::move(setup))}, {}},
        ModbusUnit(address, memory, counters) {}

 private:
  static DeviceSetup begun(DeviceSetup setup) {
    setup.start = test::kBegin;
    return setup;
  }
};

}  // namespace fieldcast::sim
