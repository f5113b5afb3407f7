#include "tests/bus/late_storm.hpp"

#include <array>
#include <stdexcept>

#include "config/loader/loader.hpp"
#include "core/codec/value_codec.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::test {
namespace {

constexpr std::string_view kSerial = "{ serial: /dev/none, baud: 19200, format: 8N1 }";

std::vector<std::string> numbered(const std::string& prefix, int from, int step, int count) {
  std::vector<std::string> all;
  for (int i = 0; i < count; ++i) all.push_back(prefix + std::to_string(from + i * step));
  return all;
}

std::vector<std::string> scattered(const std::string& prefix) {
  auto all = numbered(prefix, 100, 150, 10);
  for (auto& near : numbered(prefix, 2000, 1, 6)) all.push_back(near);
  return all;
}

std::uint64_t content(std::size_t device, AreaIndex area, std::uint32_t item) {
  std::uint64_t hash = 0x9E3779B97F4A7C15u * (device * 1000003u + area * 70001u + item + 1);
  hash ^= hash >> 29;
  return hash * 0xBF58476D1CE4E5B9u >> 17;
}

std::uint64_t cut(std::uint64_t number, unsigned bits) {
  return bits >= 64 ? number : number & ((std::uint64_t{1} << bits) - 1);
}

}  // namespace

std::span<const StormKind> storm_kinds() {
  static const std::vector<StormKind> kinds{
      {"modbus-rtu", "modbus-rtu", "", std::string(kSerial), 3, scattered("holding:"), "uint16"},
      {"modbus-ascii", "modbus-ascii", "", std::string(kSerial), 3, scattered("holding:"),
       "uint16"},
      {"modbus-tcp", "modbus-tcp", "", "{ tcp: \"127.0.0.1:1502\" }", 3, scattered("holding:"),
       "uint16"},
      {"allen-bradley-df1", "allen-bradley-df1", "", std::string(kSerial), 1,
       numbered("N7:", 0, 30, 30), "uint16"},
      {"allen-bradley-df1 half duplex", "allen-bradley-df1", ", options: { duplex: half }",
       std::string(kSerial), 2, numbered("N7:", 0, 30, 30), "uint16"},
      {"s7-ppi", "s7-ppi", "", std::string(kSerial), 2, numbered("VW", 100, 60, 30), "uint16"},
      {"s7-freeport",
       "s7-freeport",
       "",
       std::string(kSerial),
       4,
       {"window:0.0", "window:1.0", "window:2.1", "window:3.2"},
       "bool",
       false,
       false},
      {"omron-hostlink C-mode", "omron-hostlink", "", std::string(kSerial), 3, scattered("DM"),
       "uint16"},
      {"omron-hostlink FINS", "omron-hostlink", ", options: { mode: fins }", std::string(kSerial),
       3, scattered("DM"), "uint16"},
      {"mitsubishi-fx", "mitsubishi-fx", "", std::string(kSerial), 1, scattered("D"), "uint16",
       false},
      {"mitsubishi-mc 3E", "mitsubishi-mc", "", "{ tcp: \"127.0.0.1:5007\" }", 3, scattered("D"),
       "uint16"},
      {"mitsubishi-mc 4E", "mitsubishi-mc", ", options: { frame: 4e }",
       "{ tcp: \"127.0.0.1:5007\" }", 3, scattered("D"), "uint16"},
      {"mitsubishi-mc-serial 4C", "mitsubishi-mc-serial", "", std::string(kSerial), 3,
       scattered("D"), "uint16"},
      {"mitsubishi-mc-serial format 2", "mitsubishi-mc-serial", ", options: { format: 2 }",
       std::string(kSerial), 3, scattered("D"), "uint16"},
      {"mitsubishi-mc-serial format 3", "mitsubishi-mc-serial", ", options: { format: 3 }",
       std::string(kSerial), 3, scattered("D"), "uint16"},
      {"mitsubishi-mc-serial format 5", "mitsubishi-mc-serial", ", options: { format: 5 }",
       std::string(kSerial), 3, scattered("D"), "uint16"},
      {"dtc", "dtc", ", options: { max-message: 64 }", std::string(kSerial), 2,
       numbered("int16:", 100, 50, 24), "uint16"},
      {"modbus-rtu-declared", "modbus-rtu-declared", "", std::string(kSerial), 3,
       scattered("holding:"), "uint16"},
  };
  return kinds;
}

BusSpec bus_of(const StormKind& kind, const std::string& timeout) {
  std::string text = "bridge: storm\nbuses:\n  - name: bus\n    port: " + kind.port +
                     "\n    protocol: " + kind.protocol +
                     "\n    defaults: { refresh: 1s, retries: 1, timeout: " + timeout +
                     " }\n    devices:\n";
  for (int d = 1; d <= kind.devices; ++d) {
    text += "      - { name: unit-" + std::to_string(d) + ", address: " + std::to_string(d) +
            kind.options + ", channels: [";
    int c = 0;
    for (const std::string& at : kind.addresses) {
      text += (c ? ", " : " ") + std::string("{ name: c") + std::to_string(c) + ", at: \"" + at +
              "\", type: " + kind.type + ", access: read-write }";
      ++c;
    }
    text += " ] }\n";
  }
  const auto loaded =
      config::load_text(text, "storm.yaml", config::disk_reader(), config::default_options());
  if (!loaded) throw std::runtime_error(kind.name + ": " + config::to_text(loaded.error().front()));
  return loaded->buses.front();
}

sim::BusFaults faults_of(const BusSpec& bus, const StormFaults& faults) {
  sim::BusFaults all;
  all.noise = faults.noise;
  all.foreign = faults.foreign;
  for (const DeviceSpec& device : bus.devices) {
    sim::DeviceFaults& own = all.devices[device.name];
    own.queues = true;
    own.late_probability = faults.late;
    own.late = faults.by;
    own.doubled = faults.doubled;
  }
  return all;
}

LateStorm::LateStorm(const StormKind& kind, const BusSpec& spec, const sim::BusFaults& faults,
                     std::uint64_t seed)
    : spec_(spec), writes_(kind.writes), random_(seed) {
  bus_ = std::make_unique<sim::VirtualBus>(spec_, faults, seed,
                                           [this](const Action& action) { see(action); });
  fill();
  good_.assign(channels_.size(), 0);
}

void LateStorm::fill() {
  for (std::size_t d = 0; d < spec_.devices.size(); ++d) {
    const auto protocol = std::move(*make_protocol(spec_.devices[d], line_of(spec_.port)));
    sim::SimDevice& device = *bus_->plant().members()[d].device;
    for (const ChannelSpec& channel : spec_.devices[d].channels) {
      const Area& area = protocol->areas()[channel.range.area];
      Bytes image;
      for (std::uint32_t i = channel.range.first; i < channel.range.end(); ++i) {
        const std::uint64_t holds = cut(content(d, channel.range.area, i), area.item_bits);
        if (!device.poke(area.name, i, holds))
          throw std::runtime_error(spec_.devices[d].name + " has no " + std::string(area.name) +
                                   " " + std::to_string(i));
        for (unsigned bits = area.item_bits; bits >= 8; bits -= 8)
          image.push_back(static_cast<std::uint8_t>(holds >> (bits - 8)));
        if (area.item_bits < 8) image.push_back(static_cast<std::uint8_t>(holds));
      }
      auto value = decode_value(channel.encoding, area.item_bits, image);
      if (!value) throw std::runtime_error(channel.name + ": no value");
      channels_.push_back({static_cast<DeviceIndex>(d), &channel, std::move(*value)});
    }
  }
}

void LateStorm::run(std::uint64_t exchanges) {
  const std::uint64_t until = counts_.exchanges + exchanges;
  while (counts_.exchanges < until) {
    const std::uint64_t before = counts_.exchanges;
    bus_->run_until(bus_->now() + std::chrono::seconds{10} / (1 + random_() % 20));
    command();
    if (counts_.exchanges == before && ++idle_ > 1000)
      throw std::runtime_error("the bus stands still");
    if (counts_.exchanges != before) idle_ = 0;
  }
}

void LateStorm::command() {
  const std::size_t channel = random_() % channels_.size();
  const Holds& holds = channels_[channel];
  Command command;
  command.requester = "storm";
  command.request_id = asked_.size();
  command.device = spec_.devices[holds.device].name;
  command.target = ChannelTarget{holds.spec->name};
  command.expires = bus_->now() + std::chrono::seconds{5};
  if (!writes_ || random_() % 2 == 0) {
    command.operation = Operation::kAcquire;
  } else {
    command.values = {holds.value};
    command.verify = random_() % 2 == 0;
  }
  asked_.push_back(channel);
  ++counts_.commands;
  bus_->feed(CommandArrived{std::move(command)});
}

void LateStorm::judge(const Holds& holds, const Value& value) {
  ++counts_.good;
  if (value == holds.value) return;
  ++counts_.wrong;
  if (!counts_.first_wrong.empty()) return;
  counts_.first_wrong = spec_.devices[holds.device].name + " " + holds.spec->at + " shows " +
                        to_text(value) + ", it holds " + to_text(holds.value) + ", at " +
                        to_text(bus_->now() - Instant{});
}

void LateStorm::see(const Action& action) {
  if (std::holds_alternative<Send>(action)) ++counts_.exchanges;
  if (const auto* publish = std::get_if<Publish>(&action)) {
    for (const Sample& sample : publish->samples) {
      if (sample.quality != Quality::kGood) continue;
      ++good_[sample.channel];
      judge(channels_[sample.channel], sample.value);
    }
  }
  if (const auto* complete = std::get_if<Complete>(&action)) {
    const CommandResult& result = complete->result;
    ++counts_.answered;
    counts_.failed += result.state == CommandState::kFailed;
    for (const Value& value : result.values) judge(channels_[asked_[result.request_id]], value);
  }
}

LateStorm::Counts LateStorm::counts() {
  Counts counts = counts_;
  for (const auto& member : bus_->plant().members()) {
    counts.late += member.dice.late();
    counts.doubled += member.dice.doubled();
  }
  return counts;
}

}  // namespace fieldcast::test
