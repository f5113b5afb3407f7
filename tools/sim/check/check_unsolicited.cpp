// Disturbs the frames that a device sends by itself. The listener of the engine must report the
// items of the device or none.

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/bus/setup/bus_setup.hpp"
#include "core/bus/wire/unsolicited_listener.hpp"
#include "tools/sim/check/requests.hpp"
#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::sim {
namespace {

constexpr Duration kLongestPeriod = std::chrono::hours{24};
constexpr int kContents = 30;  // different contents of the records
constexpr int kNoises = 200;   // for the last contents

BusSpec listening_bus(const Subject& subject, std::span<const Area> areas) {
  BusSpec bus;
  bus.name = "check";
  bus.port = subject.port;
  bus.devices = {subject.device};
  for (std::size_t area = 0; area < areas.size(); ++area) {
    if (areas[area].unsolicited == Duration::zero()) continue;
    ChannelSpec channel;
    channel.name = channel.at = areas[area].name;
    channel.range = {static_cast<AreaIndex>(area), 0, 1};
    channel.unsolicited = true;
    bus.devices[0].channels.push_back(channel);
  }
  return bus;
}

class UnsolicitedCheck {
 public:
  UnsolicitedCheck(const Subject& subject, CheckRows& rows)
      : subject_(subject),
        requests_(subject),
        live_(subject),
        setup_(listening_bus(subject, requests_.protocol().areas())),
        rows_(rows) {}

  void run() {
    if (setup_.device(0).channels.empty()) return;
    const std::size_t first = rows_.size();
    for (const char* check : {"values", "splits", "truncations", "flipped bits", "noise before"})
      rows_.push_back({.check = check, .where = "unsolicited frames"});
    for (int round = 0; round < kContents; ++round) {
      send();
      judge(rows_[first], hear({&sent_}), false, "undisturbed", sent_);
    }
    for (std::size_t cut = 1; cut < sent_.size(); ++cut) {
      const Bytes head(sent_.begin(), sent_.begin() + static_cast<std::ptrdiff_t>(cut));
      const Bytes tail(sent_.begin() + static_cast<std::ptrdiff_t>(cut), sent_.end());
      judge(rows_[first + 1], hear({&head, &tail}), false, fmt::format("split at {}", cut), sent_);
      judge(rows_[first + 2], hear({&head}), true, fmt::format("cut to {}", cut), head);
      judge(rows_[first + 2], hear({&tail}), true, fmt::format("without the first {}", cut), tail);
    }
    flip(rows_[first + 3]);
    add_noise(rows_[first + 4]);
  }

 private:
  using Heard = std::vector<UnsolicitedListener::Frame>;

  // Fills the records and stores their frames in `sent_`.
  void send() {
    expected_.clear();
    for (const ChannelSpec& channel : setup_.device(0).channels) {
      Bytes& image = expected_[channel.range.area];
      for (const Slot& place : requests_.places(channel.range.area)) {
        (void)Requests::poke(live_.device(), channel.name, place,
                             Requests::contents(place, random_));
        append(image, *Requests::peek(live_.device(), channel.name, place, live_.now()));
      }
    }
    const auto receiver = live_.device().open_receiver();
    Reaction reaction;
    receiver->send(live_.now(), reaction);  // only begins
    receiver->send(live_.now() + kLongestPeriod, reaction);
    sent_ = std::move(reaction.response);
  }

  // Behind an undisturbed transmission, so that the listener has found the beginning of a frame.
  [[nodiscard]] Heard hear(const std::vector<const Bytes*>& pieces) const {
    UnsolicitedListener listener(setup_);
    (void)listener.on_bytes(sent_, live_.now());
    Heard heard;
    for (const Bytes* piece : pieces) {
      for (auto& frame : listener.on_bytes(*piece, live_.now())) heard.push_back(std::move(frame));
    }
    return heard;
  }

  [[nodiscard]] bool is_right(const UnsolicitedListener::Frame& frame) const {
    const auto own = expected_.find(frame.range.area);
    return own != expected_.end() && own->second == frame.items;
  }
  // `may_miss`: frames may be missing.
  void judge(CheckRow& row, const Heard& heard, bool may_miss, const std::string& what,
             const Bytes& bytes) const {
    const bool right = std::ranges::all_of(
        heard, [this](const UnsolicitedListener::Frame& frame) { return is_right(frame); });
    if (right && (may_miss || heard.size() == expected_.size())) return row.pass();
    std::string text;
    for (const auto& frame : heard)
      text += fmt::format(" {} [{}]", requests_.area_name(frame.range.area), to_hex(frame.items));
    row.fail(fmt::format("{}: heard{}", what, text.empty() ? " nothing" : text), to_hex(bytes));
  }

  void flip(CheckRow& row) const {
    std::uint64_t unseen = 0;
    for (std::size_t bit = 0; bit < sent_.size() * 8; ++bit) {
      Bytes flipped = sent_;
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      const Heard heard = hear({&flipped});
      const bool right = std::ranges::all_of(
          heard, [this](const UnsolicitedListener::Frame& frame) { return is_right(frame); });
      unseen += right ? 0 : 1;
      judge(row, subject_.checked ? heard : Heard{}, true,
            fmt::format("bit {} of byte {} flipped", bit % 8, bit / 8), flipped);
    }
    if (!subject_.checked)
      row.note = fmt::format("frames have no check: {} flipped bits pass unseen", unseen);
  }

  void add_noise(CheckRow& row) {
    for (int round = 0; round < kNoises; ++round) {
      Bytes noisy(1 + random_() % 12);
      for (std::uint8_t& byte : noisy) byte = static_cast<std::uint8_t>(random_());
      const std::size_t noise = noisy.size();
      append(noisy, sent_);
      if (frame_begins_in(subject_, noisy, noise))
        row.pass();
      else
        judge(row, hear({&noisy}), true, "behind noise", noisy);
    }
  }

  const Subject& subject_;
  Requests requests_;
  LiveDevice live_;
  const BusSetup setup_;
  CheckRows& rows_;
  Bytes sent_;
  std::map<AreaIndex, Bytes> expected_;  // the images of the records
  std::mt19937 random_{20};
};

}  // namespace

void check_unsolicited(const Subject& subject, CheckRows& rows) {
  UnsolicitedCheck(subject, rows).run();
}

}  // namespace fieldcast::sim
