#include "bridge/program/device_registry.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

namespace fieldcast::program {

namespace asio = boost::asio;

namespace {

// Whoever has the device is told that it is taken back; bytes that still leave for it are cut off.
std::function<void(std::string)> revoker(std::shared_ptr<Hold> hold,
                                         std::function<void(std::string)> revoked) {
  return [hold = std::move(hold), revoked = std::move(revoked)](const std::string& reason) {
    if (hold->over) return;
    if (const auto end = hold->leaving.lock()) return end->close();
    revoked(reason);
  };
}

}  // namespace

void DeviceRegistry::add(const BusSpec& bus, const std::shared_ptr<BusRunner>& runner) {
  const std::lock_guard lock(mutex_);
  for (const DeviceSpec& device : bus.devices) {
    if (!device.number.empty()) targets_[device.number] = {bus.name, device.name, runner};
  }
  const auto* dial_in = std::get_if<DialInPortSpec>(&bus.port);
  if (dial_in && !bus.devices.empty())
    targets_[dial_in->number] = {bus.name, bus.devices.front().name, runner};
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

std::shared_ptr<Hold> DeviceRegistry::take(const std::string& number, const std::string& who,
                                           Handlers handlers) {
  auto hold = std::make_shared<Hold>();
  hold->number = number;
  hold->who = who;
  hold->device = number;
  hold->bus = "dial-in";
  try_take(hold, std::move(handlers));
  return hold;
}

void DeviceRegistry::try_take(const std::shared_ptr<Hold>& hold, Handlers handlers) {
  if (hold->over) return;  // given back while it was parked
  const std::string& number = hold->number;
  const auto refuse = [&](Reply why, std::string reason) {
    hold->over = true;
    asio::post(io_, [refused = std::move(handlers.refused), why, reason = std::move(reason)] {
      refused({why, reason});
    });
  };
  const auto target = find(number);
  if (target) {
    hold->bus = target->bus;
    hold->device = target->device;
  }
  if (const auto held = held_.find(number); held != held_.end()) {
    if (held->second->leaving.expired() || parked_.size() >= kMaxParked)
      return refuse(Reply::kInUse, "in use by " + held->second->who);
    parked_.emplace_back(hold, std::move(handlers));  // it is free as soon as its last bytes left
    return;
  }
  if (target) {
    hold->runner = target->runner;
    held_[number] = hold;
    return ask_bus(hold, std::make_shared<Handlers>(std::move(handlers)));
  }
  FileDescriptor line;
  if (modules_) line = modules_->lease(number, revoker(hold, std::move(handlers.revoked)));
  if (!line.valid())
    return refuse(Reply::kNotOnline, "no device of this number is known or has dialled in");
  held_[number] = hold;
  hold->granted = true;
  asio::post(io_, [hold, granted = std::move(handlers.granted),
                   line = std::make_shared<FileDescriptor>(std::move(line))] {
    if (!hold->over) granted(std::move(*line));
  });
}

// The number is free: whoever came while its last bytes left is served in turn.
void DeviceRegistry::free(const std::shared_ptr<Hold>& hold) {
  const auto held = held_.find(hold->number);
  if (held == held_.end() || held->second != hold) return;
  held_.erase(held);
  for (auto& [next, handlers] : std::exchange(parked_, {})) try_take(next, std::move(handlers));
}

void DeviceRegistry::ask_bus(const std::shared_ptr<Hold>& hold,
                             const std::shared_ptr<Handlers>& handlers) {
  auto answered = [self = shared_from_this(), hold,
                   handlers](tl::expected<LeasedLine, LeaseRefused> lease) {
    asio::post(
        self->io_,
        [self, hold, handlers,
         lease = std::make_shared<tl::expected<LeasedLine, LeaseRefused>>(std::move(lease))] {
          if (!*lease) {
            if (hold->over) return;
            hold->over = true;
            self->free(hold);
            return handlers->refused(
                {lease->error().in_use ? Reply::kInUse : Reply::kNotOnline, lease->error().reason});
          }
          LeasedLine& line = lease->value();
          if (hold->over) {  // given back while the bus was asked
            line.line.reset();
            return hold->runner->end_lease(line.lease, std::nullopt);
          }
          hold->granted = true;
          hold->lease = line.lease;
          hold->settings = line.settings;
          handlers->granted(std::move(line.line));
        });
  };
  auto revoked = [self = shared_from_this(), hold, handlers](std::string reason) {
    asio::post(self->io_, [revoke = revoker(hold, handlers->revoked), reason = std::move(reason)] {
      revoke(reason);
    });
  };
  hold->runner->lease(hold->who, std::move(answered), std::move(revoked));
}

void DeviceRegistry::give_back(const std::shared_ptr<Hold>& hold, std::optional<std::string> lost) {
  if (std::exchange(hold->over, true)) return;
  if (hold->granted && hold->runner) {  // not granted: the answer of the bus finds it over
    hold->runner->end_lease(hold->lease, std::move(lost));
  } else if (hold->granted && modules_) {
    modules_->end_lease(hold->number, lost.has_value());
  }
  free(hold);
}

std::vector<HeldDevice> DeviceRegistry::held() const {
  std::vector<HeldDevice> all;
  for (const auto& [number, hold] : held_)
    all.push_back({number, hold->bus, hold->device, hold->who});
  return all;
}

}  // namespace fieldcast::program
