// Converts an EPICS record of drvModbusAsyn to points. Pure.
#pragma once

#include <optional>
#include <string>

#include "tools/import/formats/epics/epics_files.hpp"
#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

// A port of drvModbusAsynConfigure.
struct ModbusPort {
  std::string octet_port;  // port of its line
  std::uint16_t slave = 0;
  unsigned function = 0;
  std::int64_t start = 0;  // -1: offsets are addresses
  std::int64_t length = 0;
  std::string data_type;
  std::int64_t poll_ms = 0;
  bool other_address_back = false;  // Wago: written registers are read at other addresses
};

// "@asynMask(PORT OFFSET MASK TIMEOUT)DRVUSER"
struct AsynLink {
  bool masked = false;
  std::string port, offset, mask, driver_user;
};
// Empty if the record has no asyn link.
[[nodiscard]] std::optional<AsynLink> link_of(const EpicsRecord& record);

// Appends one point for each element. Returns the reason if it cannot be imported.
[[nodiscard]] MayFail read_epics_record(const EpicsRecord& record, const AsynLink& link,
                                        const ModbusPort& port, std::vector<Point>& points);

// Whether read_epics_record() uses this field of records of some type.
[[nodiscard]] bool uses_epics_field(std::string_view name);

}  // namespace fieldcast::importing
