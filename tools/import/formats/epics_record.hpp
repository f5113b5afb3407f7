// One record of an EPICS database behind drvModbusAsyn, as a point. Pure.
#pragma once

#include <optional>
#include <string>

#include "tools/import/formats/epics_files.hpp"
#include "tools/import/model.hpp"

namespace fieldcast::importing {

// A port that drvModbusAsynConfigure made.
struct ModbusPort {
  std::string octet_port;  // behind which line
  std::uint16_t slave = 0;
  unsigned function = 0;
  std::int64_t start = 0;  // -1: offsets are addresses
  std::int64_t length = 0;
  std::string data_type;
  std::int64_t poll_ms = 0;
  bool other_address_back = false;  // Wago: written registers are read elsewhere
};

// "@asynMask(PORT OFFSET MASK TIMEOUT)DRVUSER"
struct AsynLink {
  bool masked = false;
  std::string port, offset, mask, driver_user;
};
// Nothing: no link of asyn.
[[nodiscard]] std::optional<AsynLink> link_of(const EpicsRecord& record);

// Appends the point of the record, or one for each element. The fault: why it cannot be moved.
[[nodiscard]] std::optional<std::string> read_epics_record(const EpicsRecord& record,
                                                           const AsynLink& link,
                                                           const ModbusPort& port,
                                                           std::vector<Point>& points);

// Whether read_epics_record() uses this field of records of some type.
[[nodiscard]] bool uses_epics_field(std::string_view name);

}  // namespace fieldcast::importing
