// What the metrics are made of: the last report of every bus and device, and the counters of the
// store. A value: it does not change once it is taken. Any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/dds/dds_link.hpp"
#include "bridge/dds/transport/rtps_fault.hpp"
#include "bridge/store/store.hpp"
#include "core/alarm/alarm_book.hpp"
#include "core/base/time.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

struct BusFigures {
  std::string bus;
  BusReport report;
  DdsLink::BusCounters dds;
  UtcTime at;  // of the report
};

struct DeviceFigures {
  std::string bus, device;
  DeviceReport report;
};

// Of a bridge that belongs to a standby group.
struct StandbyFigures {
  bool master = false, ready = false;
  std::uint32_t term = 0;
  std::uint64_t takeovers = 0;  // times that this bridge became master
  std::uint64_t behind = 0;     // blocks of the master that it has not followed yet
};

struct MetricsSnapshot {
  std::string bridge;  // its name
  std::vector<std::shared_ptr<const BusFigures>> buses;
  std::vector<std::shared_ptr<const DeviceFigures>> devices;
  std::optional<AlarmCounts> alarms;
  std::optional<StoreCounters> store;  // nothing: there is no store
  std::optional<StandbyFigures> standby;
  RtpsFaultCounts refused_datagrams{};          // by all guards of this process
  std::optional<std::uint32_t> receive_buffer;  // bytes of a UDP socket; nothing: not known
};

}  // namespace fieldcast
