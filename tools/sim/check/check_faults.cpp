// Runs the engine with two devices, one often late: no channel may show another's value.

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/bus/bus_engine.hpp"
#include "core/codec/value_codec.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/sim/check/requests.hpp"
#include "tools/sim/check/sim_check.hpp"
#include "tools/sim/device/declared_device.hpp"

namespace fieldcast::sim {

namespace {

using namespace std::chrono_literals;

constexpr Duration kRun = 20s;
constexpr std::size_t kMostChannels = 12;

class LateBus {
 public:
  LateBus(const Subject& subject, CheckRow& row)
      : requests_(subject), row_(row), spec_(bus_of(subject)) {
    BusFaults faults;
    DeviceFaults& own = faults.devices[spec_.devices[0].name];
    own.late_probability = 0.2;
    own.late = 60ms;  // longer than the learned response time, shorter than the timeout
    for (const DeviceSpec& device : spec_.devices) faults.devices[device.name].form = subject.form;
    auto plant = SimBus::make(spec_, faults, 3, now_);
    if (!plant) throw std::runtime_error(plant.error());
    plant_ = std::move(*plant);
    line_ = plant_->open_line();
    for (std::size_t device = 0; device < spec_.devices.size(); ++device) add_channels(device);
    engine_ = std::make_unique<BusEngine>(spec_);
  }

  void run() {
    feed(Opened{});

    while (now_ < Instant{} + kRun) {
      const Instant next = std::min(timer_, line_->next_due());
      if (next == kNever)
        return row_.fail("the bus stands still from " + to_text(now_ - Instant{}), "");
      now_ = std::max(now_, next);
      Bytes received;
      line_->advance(now_, received);
      if (!received.empty()) feed(Received{received});
      if (timer_ <= now_) {
        timer_ = kNever;
        feed(TimerFired{});
      }
    }
    if (row_.tried == 0) row_.fail("no good sample in " + to_text(kRun), "");
  }

 private:
  static BusSpec bus_of(const Subject& subject) {
    BusSpec bus;
    bus.name = "check";
    bus.port = subject.port;
    std::vector<Subject> members{subject};
    if (const auto neighbour = subject.neighbour()) members.push_back(*neighbour);
    for (const Subject& each : members) {
      bus.devices.push_back(each.device);
      bus.devices.back().name += std::to_string(bus.devices.size());
      bus.devices.back().timeout = 100ms;
    }
    return bus;
  }

  static Encoding encoding_of(const Slot& slot) {
    Encoding encoding{ValueType::kBool};
    if (slot.text_bytes != 0) {
      encoding.type = ValueType::kString;
      encoding.string_bytes = slot.text_bytes;
      return encoding;
    }
    switch (slot.item_bits * slot.range.count) {
      case 8: encoding.type = ValueType::kUint8; break;
      case 16: encoding.type = ValueType::kUint16; break;
      case 32: encoding.type = ValueType::kUint32; break;
      case 64: encoding.type = ValueType::kUint64; break;
      default: break;
    }
    return encoding;
  }

  void add_channels(std::size_t device) {
    DeviceSpec& spec = spec_.devices[device];
    for (std::size_t i = 0;
         i < requests_.protocol().areas().size() && spec.channels.size() < kMostChannels; ++i) {
      const auto area = static_cast<AreaIndex>(i);
      const Area& shape = requests_.protocol().areas()[i];
      auto slots = requests_.places(area);
      if (slots.empty()) slots = requests_.slots(area, 1);
      for (const Slot& slot : slots) {
        const Bytes image = Requests::contents(slot, random_);
        if (!Requests::poke(*plant_->members()[device].device, shape.name, slot, image)) continue;
        ChannelSpec channel;
        channel.name = fmt::format("c{}", spec.channels.size());
        channel.range = slot.range;
        channel.encoding = encoding_of(slot);
        channel.refresh = 500ms;
        channel.unsolicited = shape.unsolicited > Duration::zero();
        spec.channels.push_back(channel);
        expected_.push_back(
            decode_value(channel.encoding, shape.item_bits, image).value_or(Value{false}));
      }
    }
  }

  void feed(const BusEvent& event) {
    Actions actions;
    engine_->on_event(event, now_, actions);
    make_plans(*engine_, now_, actions);
    bool reopen = false;
    for (const Action& action : actions) {
      reopen = reopen || std::holds_alternative<Reopen>(action);
      if (const auto* send = std::get_if<Send>(&action)) line_->receive(send->bytes, now_);
      if (const auto* timer = std::get_if<SetTimer>(&action)) timer_ = std::max(timer->at, now_);
      if (const auto* publish = std::get_if<Publish>(&action)) {
        for (const Sample& sample : publish->samples) judge(sample);
      }
    }
    if (!reopen) return;
    line_ = plant_->open_line();
    feed(Opened{});
  }

  void judge(const Sample& sample) {
    if (sample.quality != Quality::kGood) return;
    if (sample.value == expected_[sample.channel]) return row_.pass();
    row_.fail(fmt::format("channel {} shows a value that is not its own at {}", sample.channel,
                          to_text(now_ - Instant{})),
              "");
  }

  Requests requests_;
  CheckRow& row_;
  BusSpec spec_;
  std::unique_ptr<SimBus> plant_;
  std::unique_ptr<BusLine> line_;
  std::unique_ptr<BusEngine> engine_;
  std::vector<Value> expected_;
  Instant now_{}, timer_ = kNever;
  std::mt19937 random_{5};
};

}  // namespace

void check_late(const Subject& subject, CheckRows& rows) {
  CheckRow row{.check = "late response", .where = "with the engine"};
  LateBus(subject, row).run();
  rows.push_back(std::move(row));
}

namespace {

constexpr std::uint8_t kCode = 4;

void refusals(const Subject& subject, const Requests& requests, CheckRows& rows) {
  CheckRow row{.check = "device errors", .where = "refusals"};
  const bool silent =
      subject.device.declaration && subject.device.declaration.value->refusals.empty();
  if (silent) row.note = "no error frame is declared: the device stays silent";
  std::uint16_t sequence = 0;
  const auto& declaration = subject.device.declaration;
  const std::uint8_t code = declaration ? declared_code(*declaration.value, kCode) : kCode;
  for (const NamedRequest& example : requests.examples()) {
    BusFaults faults;
    for (const Area& area : requests.protocol().areas()) {
      faults.devices[subject.device.name].refused.push_back(
          {std::string(area.name), 0, area.items - 1, code});
    }
    LiveDevice live(subject, faults);
    const RunOutcome outcome =
        live.run(requests.protocol().begin(example.request, live.context(++sequence)));
    const bool each =
        outcome.done && std::ranges::all_of(outcome.reply, [](const RangeReply& range) {
          return range.cause == Cause::kDeviceError;
        });
    const bool refused =
        each || outcome.cause == Cause::kDeviceError || outcome.cause == Cause::kDeviceBusy;
    (silent ? outcome.cause == Cause::kNoResponse : refused)
        ? row.pass()
        : row.fail(fmt::format("{}: {}", example.name, outcome.text()), frames(outcome.responses));
  }
  rows.push_back(std::move(row));
}

void silence(const Subject& subject, const Requests& requests, CheckRows& rows) {
  CheckRow row{.check = "silence", .where = "a dead device"};
  BusFaults faults;
  faults.devices[subject.device.name].silence.push_back({});
  LiveDevice live(subject, faults);
  std::uint16_t sequence = 0;
  for (const NamedRequest& example : requests.examples()) {
    const RunOutcome outcome =
        live.run(requests.protocol().begin(example.request, live.context(++sequence)));
    outcome.cause == Cause::kNoResponse && !outcome.done
        ? row.pass()
        : row.fail(fmt::format("{}: {}", example.name, outcome.text()), frames(outcome.sent));
  }
  rows.push_back(std::move(row));
}

// Responses of a neighbour; with sequence numbers also of the previous request.
void foreign_responses(const Subject& subject, const Requests& requests, CheckRows& rows) {
  CheckRow row{.check = "wrong station", .where = "responses"};
  CheckRow old{.check = "late response", .where = "of the request before"};
  const ResponseIdentity identity = requests.protocol().traits().identity;
  if (identity == ResponseIdentity::kNone)
    row.note =
        "responses carry no address: the engine lets the line fall silent (see late response)";
  if (identity != ResponseIdentity::kSequence)
    old.note = "responses carry no sequence: the engine keeps requests apart";
  const std::optional<Subject> neighbour = subject.neighbour();
  if (!neighbour) row.note = "one address: there is no other station";
  const Subject& other_subject = neighbour ? *neighbour : subject;
  const auto other = other_subject.protocol();
  LiveDevice there(other_subject), here(subject);
  std::uint16_t sequence = 0;
  for (const NamedRequest& example : requests.examples()) {
    ++sequence;
    const auto check_replay = [&](CheckRow& into, Bytes session, const RunOutcome& recorded) {
      const RunOutcome outcome =
          replay(requests.protocol().begin(example.request, {sequence, &session}), subject.line(),
                 recorded.responses);
      outcome.is_definite() ? into.fail(fmt::format("{}: {}", example.name, outcome.text()),
                                        frames(recorded.responses))
                            : into.pass();
    };
    if (identity != ResponseIdentity::kNone && neighbour)
      check_replay(row, Bytes(there.session()),
                   there.run(other->begin(example.request, there.context(sequence))));
    if (identity == ResponseIdentity::kSequence) {
      const auto after = static_cast<std::uint16_t>(sequence + 1);
      check_replay(old, Bytes(here.session()),
                   here.run(requests.protocol().begin(example.request, here.context(after))));
    }
  }
  rows.push_back(std::move(row));
  rows.push_back(std::move(old));
}

}  // namespace

void check_faults(const Subject& subject, CheckRows& rows) {
  const Requests requests(subject);
  refusals(subject, requests, rows);
  silence(subject, requests, rows);
  foreign_responses(subject, requests, rows);
}

}  // namespace fieldcast::sim
