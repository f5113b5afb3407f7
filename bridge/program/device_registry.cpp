#include "bridge/program/device_registry.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

namespace fieldcast::program {

namespace asio = boost::asio;

namespace {

// Notifies the holder that the device is revoked; bytes still being sent to the device are cut off.
std::function<void(std::string)> revoker(std::shared_ptr<DeviceLease> lease,
                                         std::function<void(std::string)> revoked) {
  return [lease = std::move(lease), revoked = std::move(revoked)](const std::string& reason) {
    if (lease->over) return;
    if (const auto end = lease->leaving.lock()) return end->close();
    revoked(reason);
  };
}

LastRequest last_request_of(const DeviceSpec& device) {
  return {device.protocol, device.declaration};
}

}  // namespace

void DeviceRegistry::add(const BusSpec& bus, const std::shared_ptr<BusRunner>& runner) {
  const auto* dial_in = std::get_if<DialInPortSpec>(&bus.port);
  const std::string module = dial_in ? dial_in->number : "";
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < bus.devices.size(); ++i) {
    const DeviceSpec& device = bus.devices[i];
    if (!device.number.empty())
      targets_[device.number] = {bus.name, device.name, runner, i, module, last_request_of(device)};
  }
  if (dial_in && !bus.devices.empty())
    targets_[module] = {bus.name, bus.devices.front().name,
                        runner,   0,
                        module,   last_request_of(bus.devices.front())};
}

void DeviceRegistry::remove(const std::string& bus) {
  const std::lock_guard lock(mutex_);
  std::erase_if(targets_, [&](const auto& target) { return target.second.bus == bus; });
}

std::optional<DeviceRegistry::Target> DeviceRegistry::find(const std::string& number) const {
  const std::lock_guard lock(mutex_);
  const auto found = targets_.find(number);
  return found == targets_.end() ? std::nullopt : std::optional(found->second);
}

std::shared_ptr<DeviceLease> DeviceRegistry::take(const std::string& number, const std::string& who,
                                                  Handlers handlers) {
  auto lease = std::make_shared<DeviceLease>();
  lease->number = number;
  lease->who = who;
  lease->device = number;
  lease->bus = "dial-in";
  try_take(lease, std::move(handlers));
  return lease;
}

void DeviceRegistry::try_take(const std::shared_ptr<DeviceLease>& lease, Handlers handlers) {
  if (lease->over) return;  // given back while it was parked
  const std::string& number = lease->number;
  const auto refuse = [&](Reply why, std::string reason) {
    lease->over = true;
    asio::post(io_, [refused = std::move(handlers.refused), why, reason = std::move(reason)] {
      refused({why, reason});
    });
  };
  const auto target = find(number);
  if (target) {
    lease->bus = target->bus;
    lease->device = target->device;
    lease->index = target->index;
    lease->last_request = target->last_request;
  }
  if (const auto leased = leases_.find(number); leased != leases_.end()) {
    if (leased->second->leaving.expired() || parked_.size() >= kMaxParked)
      return refuse(Reply::kInUse, "in use by " + leased->second->who);
    // the device is free as soon as its last bytes are sent
    parked_.emplace_back(lease, std::move(handlers));
    return;
  }
  if (target) {
    lease->runner = target->runner;
    leases_[number] = lease;
    return ask_bus(lease, std::make_shared<Handlers>(std::move(handlers)));
  }
  FileDescriptor line;
  if (modules_) line = modules_->lease(number, revoker(lease, std::move(handlers.revoked)));
  if (!line.valid())
    return refuse(Reply::kNotOnline, "no device of this number is known or has dialled in");
  leases_[number] = lease;
  lease->granted = true;
  asio::post(io_, [lease, granted = std::move(handlers.granted),
                   line = std::make_shared<FileDescriptor>(std::move(line))] {
    if (!lease->over) granted(std::move(*line));
  });
}

// Frees the number and serves the requests that arrived while its last bytes were sent.
void DeviceRegistry::free(const std::shared_ptr<DeviceLease>& lease) {
  const auto leased = leases_.find(lease->number);
  if (leased == leases_.end() || leased->second != lease) return;
  leases_.erase(leased);
  for (auto& [next, handlers] : std::exchange(parked_, {})) try_take(next, std::move(handlers));
}

void DeviceRegistry::ask_bus(const std::shared_ptr<DeviceLease>& lease,
                             const std::shared_ptr<Handlers>& handlers) {
  auto on_response = [self = shared_from_this(), lease,
                      handlers](tl::expected<LeasedLine, LeaseRefused> response) {
    asio::post(
        self->io_,
        [self, lease, handlers,
         response = std::make_shared<tl::expected<LeasedLine, LeaseRefused>>(std::move(response))] {
          if (!*response) {
            if (lease->over) return;
            lease->over = true;
            self->free(lease);
            return handlers->refused({response->error().in_use ? Reply::kInUse : Reply::kNotOnline,
                                      response->error().reason});
          }
          LeasedLine& line = response->value();
          if (lease->over) {  // given back while the bus request was pending
            line.line.reset();
            return lease->runner->end_lease(line.lease, std::nullopt);
          }
          lease->granted = true;
          lease->bus_lease = line.lease;
          lease->format = line.format;
          lease->settings = line.settings;
          lease->at_server = line.at_server;
          lease->tap = line.tap;
          handlers->granted(std::move(line.line));
        });
  };
  auto revoked = [self = shared_from_this(), lease, handlers](std::string reason) {
    asio::post(self->io_, [revoke = revoker(lease, handlers->revoked), reason = std::move(reason)] {
      revoke(reason);
    });
  };
  lease->runner->lease(lease->who, std::move(on_response), std::move(revoked));
}

void DeviceRegistry::give_back(const std::shared_ptr<DeviceLease>& lease,
                               std::optional<std::string> lost) {
  if (std::exchange(lease->over, true)) return;
  // if not granted, the response of the bus finds the lease ended
  if (lease->granted && lease->runner) {
    lease->runner->end_lease(lease->bus_lease, std::move(lost));
  } else if (lease->granted && modules_) {
    modules_->end_lease(lease->number, lost.has_value());
  }
  free(lease);
}

ListedDevice DeviceRegistry::listed(const std::string& number, const Target& target) const {
  using State = ListedDevice::State;
  ListedDevice device{number, target.bus, target.device, State::kFree, {}};
  for (const auto& [leased, lease] : leases_) {
    if (leased != number && (!target.runner || lease->runner != target.runner)) continue;
    device.state = State::kInUse;
    device.who = lease->who;
    return device;
  }
  if (!target.dial_in.empty() && !(modules_ && modules_->connected(target.dial_in)))
    device.state = State::kNotOnline;
  return device;
}

std::vector<ListedDevice> DeviceRegistry::devices() const {
  std::map<std::string, Target> all;
  if (modules_) {
    for (const std::string& number : modules_->kept()) all[number] = {"dial-in", number, nullptr};
  }
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [number, target] : targets_) all[number] = target;
  }
  std::vector<ListedDevice> devices;
  for (const auto& [number, target] : all) devices.push_back(listed(number, target));
  return devices;
}

std::vector<LeasedDevice> DeviceRegistry::leased() const {
  std::vector<LeasedDevice> all;
  for (const auto& [number, lease] : leases_)
    all.push_back({number, lease->bus, lease->device, lease->who});
  return all;
}

}  // namespace fieldcast::program
