#include "tools/sim/bus/sim_bus.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/model/bus_spec.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/sim/device/waveform.hpp"

namespace fieldcast::sim {
namespace {

std::string known_protocols() {
  std::string names;
  for (const DeviceKind& kind : device_kinds())
    names += (names.empty() ? "" : ", ") + std::string(kind.protocol);
  return names;
}

// Without calculated channels, which no device has.
BusSpec on_the_wire(BusSpec spec) {
  for (DeviceSpec& device : spec.devices)
    std::erase_if(device.channels.own(), [](const ChannelSpec& channel) {
      return static_cast<bool>(channel.calculation);
    });
  return spec;
}

}  // namespace

SimBus::SimBus(const BusSpec& spec, const BusFaults& faults, std::uint64_t seed, Instant start)
    : spec_(on_the_wire(spec)), faults_(faults), seed_(mix(seed, spec.name)), start_(start) {}

tl::expected<std::unique_ptr<SimBus>, std::string> SimBus::make(const BusSpec& spec,
                                                                const BusFaults& faults,
                                                                std::uint64_t seed, Instant start) {
  std::unique_ptr<SimBus> bus(new SimBus(spec, faults, seed, start));
  const bool tcp = std::holds_alternative<TcpPortSpec>(spec.port);
  for (const DeviceSpec& device : bus->spec_.devices) {
    const DeviceKind* kind = kind_of(device);
    if (kind == nullptr) {
      return tl::unexpected(fmt::format("{}/{}: no simulated devices speak '{}'; there are: {}",
                                        spec.name, device.name, device.protocol,
                                        known_protocols()));
    }
    const auto found = faults.devices.find(device.name);
    const DeviceFaults own = found == faults.devices.end() ? DeviceFaults{} : found->second;
    DeviceSetup setup{device,
                      line_of(spec.port),
                      tcp,
                      bus->members_.empty(),
                      own.refused,
                      own.only_configured,
                      mix(bus->seed_, device.name),
                      start,
                      own.form};
    auto made = kind->make(setup);
    if (!made) return tl::unexpected(fmt::format("{}/{}", spec.name, made.error()));
    bus->half_duplex_ = bus->half_duplex_ && kind->half_duplex;
    bus->members_.push_back(
        {device.name, std::move(*made), FaultDice(own, mix(setup.seed, "faults"))});
  }
  if (faults.foreign > 0 && !bus->spec_.devices.empty()) {
    if (auto made = bus->make_foreign(*kind_of(bus->spec_.devices.front())); !made)
      return tl::unexpected(made.error());
  }
  return bus;
}

tl::expected<void, std::string> SimBus::make_foreign(const DeviceKind& kind) {
  foreign_.spec = spec_.devices.front();
  foreign_.spec.name = "foreign";
  const LineFormat line = line_of(spec_.port);
  auto protocol = make_protocol(foreign_.spec, line);
  if (!protocol) return tl::unexpected(protocol.error().what);
  const Traits& traits = (*protocol)->traits();
  std::uint16_t address = traits.highest_address;
  const auto taken = [&] {
    return std::ranges::any_of(
        spec_.devices, [&](const DeviceSpec& device) { return device.link.address == address; });
  };
  while (address > traits.lowest_address && taken()) --address;
  foreign_.spec.link.address = address;
  foreign_.spec.link.long_address.clear();
  foreign_.protocol = std::move(*make_protocol(foreign_.spec, line));
  auto device = kind.make({.spec = foreign_.spec,
                           .line = line,
                           .stream = std::holds_alternative<TcpPortSpec>(spec_.port),
                           .seed = mix(seed_, "foreign"),
                           .start = start_});
  if (!device) return tl::unexpected(device.error());
  foreign_.device = std::move(*device);
  return {};
}

std::unique_ptr<BusLine> SimBus::open_line() {
  const std::uint64_t seed = mix(seed_, ++statistics_.connections);
  const auto* tcp = std::get_if<TcpPortSpec>(&spec_.port);
  WireOptions options{line_of(spec_.port),
                      tcp == nullptr || tcp->line.has_value(),
                      half_duplex_,
                      faults_.fifo,
                      faults_.echo,
                      faults_.noise,
                      seed};
  return std::make_unique<BusLine>(*this, options, seed);
}

BusLine::BusLine(SimBus& bus, const WireOptions& options, std::uint64_t seed)
    : bus_(bus), wire_(options), random_(mix(seed, "babble")) {
  for (const SimBus::Member& member : bus.members_)
    receivers_.push_back(member.device->open_receiver());
  spoke_until_.assign(receivers_.size(), kLongAgo);
}

void BusLine::receive(ByteView bytes, Instant now, std::optional<std::uint32_t> response_baud) {
  bus_.statistics_.bytes_received += bytes.size();
  const std::uint64_t lost = wire_.lost(), collisions = wire_.collisions();
  wire_.from_master(bytes, now, response_baud);
  bus_.statistics_.lost += wire_.lost() - lost;
  bus_.statistics_.collisions += wire_.collisions() - collisions;
  if (const auto rest = wire_.shortest_rest()) {
    bus_.statistics_.shortest_rest =
        std::min(bus_.statistics_.shortest_rest.value_or(*rest), *rest);
  }
  if (next_babble_ == kNever) plan_babble(now);
  if (next_foreign_ == kNever) plan_foreign(now);
}

void BusLine::plan_foreign(Instant from) {
  if (bus_.faults_.foreign <= 0) return;
  std::exponential_distribution<double> wait(bus_.faults_.foreign);
  next_foreign_ = from + from_seconds(std::min(wait(random_), 3600.0));
}

// Sends all rounds of an exchange. A link without a shared line carries only the responses.
void BusLine::send_to_foreign(Instant now) {
  constexpr std::uint32_t kMostItems = 16;
  constexpr int kMostRounds = 8;
  constexpr Duration kResponseAfter = std::chrono::milliseconds{2};
  plan_foreign(now);
  const SimBus::Foreign& foreign = bus_.foreign_;
  const auto& channels = foreign.spec.channels;
  if (channels.empty()) return;
  Range range = channels[random_() % channels.size()].range;
  const Range alone = range;
  range.count = 1 + static_cast<std::uint32_t>(random_() % kMostItems);
  if (!foreign.protocol->size(ReadRequest{{range}})) range = alone;
  const auto exchange =
      foreign.protocol->begin(ReadRequest{{range}}, {static_cast<std::uint16_t>(random_())});
  const auto receiver = foreign.device->open_receiver();
  Bytes request;
  Step step = exchange->start(request);
  for (int round = 0; round < kMostRounds && step.kind == Step::Kind::kSend; ++round) {
    if (bus_.half_duplex_) {
      wire_.from_device(kNobody, request, now);
      now = wire_.sends_until(kNobody);
    }
    Reaction reaction;
    for (const std::uint8_t character : request) receiver->on_character(character, now, reaction);
    wire_.from_device(kNobody, reaction.response, now + kResponseAfter);
    now = std::max(now, wire_.sends_until(kNobody)) + kResponseAfter;
    request.clear();
    step = exchange->on_bytes(reaction.response, request);
    if (step.kind == Step::Kind::kNeedMore && step.wait == Wait::kPause)
      step = exchange->on_silence(request);
  }
}

void BusLine::plan_babble(Instant from) {
  if (bus_.faults_.babble <= 0) return;
  std::exponential_distribution<double> wait(bus_.faults_.babble);
  next_babble_ = from + from_seconds(std::min(wait(random_), 3600.0));
}

void BusLine::babble(Instant now) {
  Bytes burst(1 + random_() % std::max(1u, bus_.faults_.babble_length));
  for (std::uint8_t& character : burst) character = static_cast<std::uint8_t>(random_());
  wire_.from_device(kNobody, burst, now);
  plan_babble(now);
}

// Only while the line is idle: a character in flight is not received yet.
Instant BusLine::silence_due() const {
  Instant due = kNever;
  if (!wire_.at_rest()) return due;
  for (const auto& receiver : receivers_) due = std::min(due, receiver->silence_due());
  return due;
}

Instant BusLine::unsolicited_due() const {
  Instant due = kNever;
  for (const auto& receiver : receivers_) due = std::min(due, receiver->sends_at());
  return due;
}

void BusLine::send_unsolicited(Instant at) {
  for (std::size_t device = 0; device < receivers_.size(); ++device) {
    if (receivers_[device]->sends_at() > at) continue;
    Reaction reaction;
    receivers_[device]->send(at, reaction);
    if (!bus_.members_[device].dice.dead(at - bus_.start_)) say(device, reaction, at);
  }
}

Instant BusLine::next_due() const {
  return std::min(
      {wire_.next_due(), silence_due(), unsolicited_due(), next_babble_, next_foreign_});
}

void BusLine::advance(Instant now, Bytes& to_master) {
  for (;;) {
    const Instant unsolicited = unsolicited_due();
    if (const auto passed =
            wire_.advance(std::min({now, unsolicited, next_babble_, next_foreign_}))) {
      if (passed->sender != kMaster) {
        append(to_master, passed->characters);
        bus_.statistics_.bytes_sent += passed->characters.size();
      }
      deliver(*passed);
    } else if (unsolicited <= std::min({now, next_babble_, next_foreign_})) {
      send_unsolicited(unsolicited == kLongAgo ? now : unsolicited);
    } else if (next_babble_ <= now && next_babble_ <= next_foreign_) {
      babble(next_babble_);
    } else if (next_foreign_ <= now) {
      send_to_foreign(next_foreign_);
    } else if (const Instant due = silence_due(); due <= now) {
      be_silent(due);
    } else {
      return;
    }
  }
}

void BusLine::deliver(const Passed& passed) {
  if (passed.sender == kEcho) return;  // the devices have received the original
  for (std::size_t device = 0; device < receivers_.size(); ++device) {
    if (passed.sender == static_cast<Sender>(device)) continue;
    Instant end = passed.first_end;
    for (const std::uint8_t character : passed.characters) {
      deliver(device, character, end);
      end += passed.character;
    }
  }
}

void BusLine::deliver(std::size_t device, std::uint8_t character, Instant end) {
  SimBus::Member& member = bus_.members_[device];
  const DeviceFaults& faults = member.dice.faults();
  const auto sender = static_cast<Sender>(device);
  const bool busy = bus_.half_duplex_ &&
                    (faults.queues ? wire_.sending(sender, end) : wire_.sends_until(sender) > end);
  const Instant spoke = spoke_until_[device];
  const bool deaf = spoke != kLongAgo && end >= spoke && end < spoke + faults.deaf;
  if (busy || deaf || member.dice.dead(end - bus_.start_)) {
    ++member.missed;
    return;
  }
  Reaction reaction;
  receivers_[device]->on_character(character, end, reaction);
  say(device, reaction, end);
}

void BusLine::be_silent(Instant at) {
  for (std::size_t device = 0; device < receivers_.size(); ++device) {
    if (receivers_[device]->silence_due() > at) continue;
    Reaction reaction;
    receivers_[device]->on_silence(at, reaction);
    say(device, reaction, at);
  }
}

void BusLine::say(std::size_t device, Reaction& reaction, Instant at) {
  hung_up_ = hung_up_ || reaction.hang_up;
  if (reaction.response.empty()) return;
  SimBus::Member& member = bus_.members_[device];
  const Bytes meant = reaction.response;
  const FaultyResponse response = member.dice.roll(std::move(reaction.response));
  if (response.characters != meant) ++member.spoiled;
  const auto sender = static_cast<Sender>(device);
  const std::uint64_t collisions = wire_.collisions();
  const Instant free = wire_.sends_until(sender);
  const Duration delay = response.delay + reaction.pause;
  const bool queues = member.dice.faults().queues;
  wire_.from_device(sender, response.characters,
                    queues ? std::max(at, free) + delay : std::max(at + delay, free),
                    reaction.baud);
  if (response.doubled && !response.characters.empty()) {
    wire_.from_device(sender, response.characters,
                      wire_.sends_until(sender) + member.dice.faults().doubled_after,
                      reaction.baud);
  }
  if (!response.characters.empty()) spoke_until_[device] = wire_.sends_until(sender);
  bus_.statistics_.collisions += wire_.collisions() - collisions;
}

}  // namespace fieldcast::sim
