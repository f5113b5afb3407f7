#include "tools/sim/check/sim_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>

#include "core/codec/value_codec.hpp"
#include "tools/sim/check/requests.hpp"

namespace fieldcast::sim {

CheckRows sim_check(const Subject& subject, const std::function<void(double share)>& on_share) {
  constexpr std::array kParts{check_values, check_notation, check_responses,
                              check_faults, check_late,     check_unsolicited};
  CheckRows rows;
  for (std::size_t i = 0; i < kParts.size(); ++i) {
    kParts[i](subject, rows);
    if (on_share) on_share(static_cast<double>(i + 1) / kParts.size());
  }
  const Requests requests(subject);
  for (CheckRow& row : rows) {
    row.variant = subject.variant;
    if (row.tried == 0 && row.note.empty() && requests.examples().empty())
      row.note = "the device is never requested: see unsolicited frames";
  }
  return rows;
}

namespace {

constexpr int kNoiseRounds = 200;
// All bits are flipped in this many characters; in later characters one bit each.
constexpr std::size_t kMostFlipped = 160;

class ResponseCheck {
 public:
  ResponseCheck(const Subject& subject, CheckRows& rows)
      : subject_(subject), requests_(subject), live_(subject), rows_(rows) {}

  void run() {
    const std::size_t first = rows_.size();
    for (const char* check : {"splits", "truncations", "flipped bits", "noise before"})
      rows_.push_back({.check = check, .where = "responses"});
    splits_ = &rows_[first], cuts_ = &rows_[first + 1], flips_ = &rows_[first + 2],
    noise_ = &rows_[first + 3];
    for (const NamedRequest& example : requests_.examples()) disturb(example);
    if (frames_in_noise_ != 0)
      noise_->note = fmt::format("{} noises contain a valid frame", frames_in_noise_);
    if (!subject_.checked) {
      flips_->note = fmt::format("responses carry no check: {} flipped bits pass unseen", unseen_);
      noise_->note = "responses carry no check";
    }
  }

 private:
  struct Example {
    const NamedRequest& named;
    std::uint16_t sequence;
    Bytes session;  // before it
    RunOutcome clean;
  };

  void disturb(const NamedRequest& named) {
    const std::uint16_t sequence = ++sequence_;
    const Bytes session = live_.session();
    const Example example{named, sequence, session,
                          live_.run(begin(named, live_.context(sequence)))};
    const RunOutcome& clean = example.clean;
    if (!clean.done && clean.cause != Cause::kDeviceError) {
      splits_->fail(fmt::format("{}: the undisturbed response: {}", named.name, clean.text()),
                    to_hex(clean.responses.back()));
      return;
    }
    for (std::size_t round = 0; round < clean.responses.size(); ++round) {
      const std::string in_round =
          clean.responses.size() > 1 ? fmt::format(" of response {}", round + 1) : "";
      split(example, round, in_round);
      truncate(example, round, in_round);
      flip_bits(example, round, in_round);
    }
    for (int round = 0; round < kNoiseRounds; ++round) add_noise(example);
  }

  void split(const Example& example, std::size_t round, const std::string& in_round) {
    const Bytes& response = example.clean.responses[round];
    for (std::size_t cut = 0; cut < response.size(); ++cut) {
      std::vector<std::size_t> cuts{cut};
      if (cut == 0) cuts.resize(response.size()), std::iota(cuts.begin(), cuts.end(), 1);
      const RunOutcome outcome = run(example, example.clean.responses, cuts);
      judge(*splits_, example, outcome, outcome.same_as(example.clean),
            fmt::format("split at {}{}", cut, in_round), response);
    }
  }

  void truncate(const Example& example, std::size_t round, const std::string& in_round) {
    for (std::size_t size = 0; size < example.clean.responses[round].size(); ++size) {
      auto responses = example.clean.responses;
      responses.resize(round + 1);
      responses[round].resize(size);
      const RunOutcome outcome = run(example, responses);
      judge(*cuts_, example, outcome, !outcome.is_definite(),
            fmt::format("cut to {}{}", size, in_round), responses[round]);
    }
  }

  void flip_bits(const Example& example, std::size_t round, const std::string& in_round) {
    const std::size_t size = example.clean.responses[round].size();
    const std::size_t step = size > kMostFlipped ? 9 : 1;
    for (std::size_t bit = 0; bit < size * 8; bit += step) {
      auto responses = example.clean.responses;
      responses[round][bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      const RunOutcome outcome = run(example, responses);
      const bool right = !outcome.is_definite() || outcome.same_as(example.clean);
      unseen_ += right ? 0 : 1;
      judge(*flips_, example, outcome, right || !subject_.checked,
            fmt::format("bit {} of byte {}{} flipped", bit % 8, bit / 8, in_round),
            responses[round]);
    }
  }

  void add_noise(const Example& example) {
    auto responses = example.clean.responses;
    Bytes noise(1 + random_() % 12);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random_());
    responses.front().insert(responses.front().begin(), noise.begin(), noise.end());
    const RunOutcome outcome = run(example, responses);
    const bool right = !outcome.is_definite() || outcome.same_as(example.clean);
    const bool frame = !right && frame_begins_in(subject_, responses.front(), noise.size());
    frames_in_noise_ += frame ? 1 : 0;
    judge(*noise_, example, outcome, right || frame || !subject_.checked, "behind " + to_hex(noise),
          responses.front());
  }

  [[nodiscard]] std::unique_ptr<Exchange> begin(const NamedRequest& named,
                                                ExchangeContext context) const {
    return requests_.protocol().begin(named.request, context);
  }
  [[nodiscard]] RunOutcome run(const Example& example, const std::vector<Bytes>& responses,
                               const std::vector<std::size_t>& cuts = {}) const {
    Bytes session = example.session;
    return replay(begin(example.named, {example.sequence, &session}), subject_.line(), responses,
                  cuts);
  }
  static void judge(CheckRow& row, const Example& example, const RunOutcome& outcome, bool right,
                    const std::string& what, const Bytes& frame) {
    if (right) return row.pass();
    row.fail(fmt::format("{}, {}: {}; undisturbed: {}", example.named.name, what, outcome.text(),
                         example.clean.text()),
             to_hex(frame));
  }

  const Subject& subject_;
  Requests requests_;
  LiveDevice live_;
  CheckRows& rows_;
  CheckRow *splits_ = nullptr, *cuts_ = nullptr, *flips_ = nullptr, *noise_ = nullptr;
  std::uint64_t unseen_ = 0, frames_in_noise_ = 0;
  std::uint16_t sequence_ = 0;
  std::mt19937 random_{20};
};

}  // namespace

void check_responses(const Subject& subject, CheckRows& rows) {
  ResponseCheck(subject, rows).run();
}

// Checks that every form of an address means the same item to the bridge and the simulated device.
namespace {

constexpr Duration kStep = std::chrono::milliseconds{250};
constexpr int kSteps = 120;  // longer than the period of any waveform

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

// Whether the form of the response that the simulated device sends has the value.
bool is_sent(const Subject& subject, const Range& range) {
  const auto& declaration = subject.device.declaration.value;
  if (declaration == nullptr || declaration->areas[range.area].places.empty()) return true;
  const auto sent = Requests(subject).places(range.area);
  return std::ranges::any_of(sent, [&](const Slot& slot) {
    return range.first < slot.range.end() && range.end() > slot.range.first;
  });
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
  channel.unsolicited = area.unsolicited > Duration::zero();
  channel.limits.low = 1;  // its waveform is never 0
  channel.limits.high = 2;
  Subject one = subject;
  one.device.channels = {channel};
  try {
    LiveDevice live(one);
    if (!shows(live.device(), area.name, channel.range, channel.encoding, live.now()))
      return "the simulated device keeps it elsewhere";
    if (channel.unsolicited || !is_sent(subject, channel.range)) return {};
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
