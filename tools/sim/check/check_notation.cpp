// Checks that every form of an address means the same item to the bridge and the simulated device.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/codec/value_codec.hpp"
#include "tools/sim/check/notations.hpp"
#include "tools/sim/check/requests.hpp"
#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::sim {
namespace {

constexpr Duration kStep = std::chrono::milliseconds{250};
constexpr int kSteps = 120;  // longer than the period of any waveform

// Looks for a non-zero item over a whole period of the waveform.
bool shows(SimDevice& device, std::string_view area, const Range& range, const Encoding& encoding,
           Instant now) {
  for (int step = 0; step < kSteps; ++step, now += kStep) {
    for (std::uint32_t item = range.first; item < range.end(); ++item) {
      const auto held = device.peek(area, item, now);
      if (held && (encoding.bit ? *held >> *encoding.bit & 1u : *held) != 0) return true;
    }
  }
  return false;
}

Range aligned(const Range& range, const Area& area) {
  const std::uint32_t first = range.first / area.alignment * area.alignment;
  const std::uint32_t end = (range.end() + area.alignment - 1) / area.alignment * area.alignment;
  return {range.area, first, std::min(end, area.items) - first};
}

std::string fault_of(const Subject& subject, const Protocol& protocol, const std::string& at) {
  const auto address = protocol.parse_address(at);
  if (!address) return "the bridge does not accept it: " + address.error().what;
  const Area& area = protocol.areas()[address->area];
  ChannelSpec channel;
  channel.name = "channel";
  channel.at = at;
  channel.encoding = natural_encoding(*address, area, subject.device.declaration.value.get());
  channel.range = {address->area, address->first, item_count(channel.encoding, area.item_bits)};
  channel.limits.low = 1;  // its waveform is never 0
  channel.limits.high = 2;
  Subject one = subject;
  one.device.channels = {channel};
  try {
    LiveDevice live(one);
    if (!shows(live.device(), area.name, channel.range, channel.encoding, live.now()))
      return "the simulated device keeps it elsewhere";
    const RunOutcome read =
        live.run(protocol.begin(ReadRequest{{aligned(channel.range, area)}}, {1}));
    return read.done ? std::string{} : "reading it: " + read.text();
  } catch (const std::runtime_error& error) {
    return std::string("the simulated device does not accept it: ") + error.what();
  }
}

}  // namespace

void check_notation(const Subject& subject, CheckRows& rows) {
  CheckRow row{.check = "notation", .where = "addresses"};
  const auto protocol = subject.protocol();
  for (const std::string& at : notations_of(subject)) {
    const std::string fault = fault_of(subject, *protocol, at);
    fault.empty() ? row.pass() : row.fail(fmt::format("'{}': {}", at, fault), "");
  }
  rows.push_back(std::move(row));
}

}  // namespace fieldcast::sim
