// Stores the samples of one bus and the state changes of its devices. Called on the bus's thread;
// never waits for the store.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "bridge/store/store.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class StoreRecorder {
 public:
  // The store outlives this object.
  StoreRecorder(Store& store, const BusSpec& bus);

  // `now`: time of publication.
  void put(std::span<const Sample> samples, const UtcMapping& mapping, Instant now);
  void put(std::string_view device, DeviceState state, UtcTime at);

 private:
  struct Device {
    std::string protocol, address;
    std::optional<DeviceState> state;  // last stored state
  };
  Store& store_;
  const std::string bus_;
  const std::unique_ptr<Store::Intake> intake_;
  std::map<std::string, Device, std::less<>> devices_;
};

}  // namespace fieldcast
