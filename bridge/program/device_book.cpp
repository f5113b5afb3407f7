#include "bridge/program/device_book.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

namespace fieldcast::program {

namespace asio = boost::asio;

void DeviceBook::add(const BusSpec& bus, const std::shared_ptr<BusRunner>& runner) {
  const std::lock_guard lock(mutex_);
  for (const DeviceSpec& device : bus.devices) {
    if (!device.number.empty()) targets_[device.number] = {bus.name, device.name, runner};
  }
  const auto* dial_in = std::get_if<DialInPortSpec>(&bus.port);
  if (dial_in && !bus.devices.empty()) targets_[dial_in->number] = {bus.name, bus.devices.front().name, runner};
}

void DeviceBook::remove(const std::string& bus) {
  const std::lock_guard lock(mutex_);
  std::erase_if(targets_, [&](const auto& target) { return target.second.bus == bus; });
}

std::optional<DeviceBook::Target> DeviceBook::find(const std::string& number) const {
  const std::lock_guard lock(mutex_);
  const auto found = targets_.find(number);
  return found == targets_.end() ? std::nullopt : std::optional(found->second);
}

std::shared_ptr<Hold> DeviceBook::take(const std::string& number, const std::string& who, Handlers handlers) {
  auto hold = std::make_shared<Hold>();
  hold->number = number;
  hold->who = who;
  hold->device = number;
  hold->bus = "dial-in";
  const auto refuse = [&](Reply why, std::string reason) {
    hold->over = true;
    asio::post(io_, [refused = std::move(handlers.refused), why, reason = std::move(reason)] { refused({why, reason}); });
    return hold;
  };
  const auto target = find(number);
  if (target) {
    hold->bus = target->bus;
    hold->device = target->device;
  }
  if (const auto held = held_.find(number); held != held_.end()) { return refuse(Reply::kInUse, "in use by " + held->second); }
  if (target) {
    hold->runner = target->runner;
    held_[number] = who;
    ask_bus(hold, std::make_shared<Handlers>(std::move(handlers)));
    return hold;
  }
  FileDescriptor line;
  if (modules_) line = modules_->lend(number, handlers.revoked);
  if (!line.valid()) return refuse(Reply::kNotOnline, "no device of this number is known or has dialled in");
  held_[number] = who;
  hold->granted = true;
  asio::post(io_, [hold, granted = std::move(handlers.granted), line = std::make_shared<FileDescriptor>(std::move(line))] {
    if (!hold->over) granted(std::move(*line));
  });
  return hold;
}

void DeviceBook::ask_bus(const std::shared_ptr<Hold>& hold, const std::shared_ptr<Handlers>& handlers) {
  auto answered = [self = shared_from_this(), hold, handlers](tl::expected<LentLine, LeaseRefused> lent) {
    asio::post(self->io_, [self, hold, handlers, lent = std::make_shared<tl::expected<LentLine, LeaseRefused>>(std::move(lent))] {
      if (!*lent) {
        if (hold->over) return;
        hold->over = true;
        self->held_.erase(hold->number);
        return handlers->refused({lent->error().in_use ? Reply::kInUse : Reply::kNotOnline, lent->error().reason});
      }
      LentLine& line = lent->value();
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
    asio::post(self->io_, [hold, handlers, reason = std::move(reason)] {
      if (!hold->over) handlers->revoked(reason);
    });
  };
  hold->runner->lease(hold->who, std::move(answered), std::move(revoked));
}

void DeviceBook::give_back(Hold& hold, std::optional<std::string> lost) {
  if (std::exchange(hold.over, true)) return;
  held_.erase(hold.number);
  if (!hold.granted) return;  // the answer of the bus finds it over
  if (hold.runner) {
    hold.runner->end_lease(hold.lease, std::move(lost));
  } else if (modules_) {
    modules_->take_back(hold.number, lost.has_value());
  }
}

}  // namespace fieldcast::program
