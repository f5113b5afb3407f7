#include "tests/bus/freeport_bus.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "config/loader/loader.hpp"

namespace fieldcast::test {
namespace {

constexpr LineFormat kLine{.baud = 9600, .data_bits = 8, .parity = Parity::kNone, .stop_bits = 1};

BusSpec spec_of(unsigned stations) {
  std::string text =
      "bridge: test\nbuses:\n  - name: bus\n    port: { serial: /dev/none, baud: 9600, format: 8N1 "
      "}\n"
      "    protocol: s7-freeport\n    defaults: { refresh: 10s, mode: intensive }\n    devices:\n";
  for (unsigned station = 1; station <= stations; ++station) {
    const std::string number = std::to_string(station);
    text += "      - { name: s" + number + ", address: " + number +
            ", channels: [{ name: window, at: \"window:0\", type: uint32 }] }\n";
  }
  const auto loaded = config::load_text(text, "stations.yaml", {});
  if (!loaded) throw std::runtime_error(to_text(loaded.error().front()));
  return loaded->buses.front();
}

bool is_digits(const std::string& text) {
  return text.find_first_not_of("0123456789ABCDEF") == std::string::npos;
}
unsigned number(const std::string& digits) {
  return static_cast<unsigned>(std::stoul(digits, nullptr, 16));
}
std::string hex(std::uint32_t value, int digits) {
  std::array<char, 9> text{};
  std::snprintf(text.data(), text.size(), "%0*X", digits, value);
  return text.data();
}
unsigned check_of(const std::string& text) {
  unsigned check = 0;
  for (const char c : text) check ^= static_cast<unsigned char>(c);
  return check;
}
Bytes framed(const std::string& text) {
  const std::string frame = "q" + text + hex(check_of(text), 2) + "Q";
  return {frame.begin(), frame.end()};
}

}  // namespace

FreeportStations::FreeportStations(unsigned count, std::uint64_t seed) : random_(seed) {
  for (unsigned station = 1; station <= count; ++station)
    windows_[station] = static_cast<std::uint32_t>(random_());
}

Bytes FreeportStations::answer(ByteView received) {
  const std::string all(received.begin(), received.end());
  const std::size_t begin = all.rfind('q');
  const std::size_t end = begin == std::string::npos ? begin : all.find('Q', begin);
  if (end == std::string::npos) return {};
  const std::string text = all.substr(begin + 1, end - begin - 1);
  if (text.size() < 5 || text.size() == 10 || !is_digits(text.substr(1, 2)))
    return {};  // 10: the response of another station
  const auto window = windows_.find(number(text.substr(1, 2)));
  if (window == windows_.end()) return {};
  const std::string length = text.substr(3, 2);
  if (text.size() != 15 || (is_digits(length) && (number(length) < 1 || number(length) > 4)))
    return framed("E02");
  if (!is_digits(text.substr(3))) return framed("E03");
  if (check_of(text.substr(0, 13)) != number(text.substr(13))) return framed("E01");
  if (text[0] != 'W') return framed("E04");
  window->second = static_cast<std::uint32_t>(random_());
  const unsigned unused = 8 * (4 - number(length));
  return framed(hex(window->second >> unused << unused, 8));
}

FreeportBus::FreeportBus(unsigned stations, double bit_error_rate, std::uint64_t seed,
                         Duration response_time)
    : engine_(spec_of(stations)),
      stations_(stations, seed),
      to_stations_(bit_error_rate, seed + 1),
      to_master_(bit_error_rate, seed + 2),
      response_time_(response_time) {
  feed(Opened{});
}

void FreeportBus::run(std::uint64_t exchanges) {
  const std::uint64_t until = counts_.exchanges + exchanges;
  while (counts_.exchanges < until || arrives_ != kNever) {
    if (arrives_ <= timer_) {
      now_ = arrives_;
      arrives_ = kNever;
      const Bytes bytes = std::move(arriving_);
      feed(Received{bytes});
    } else if (timer_ != kNever) {
      now_ = std::max(now_, timer_);
      timer_ = kNever;
      feed(TimerFired{});
    } else {
      throw std::logic_error("the engine waits for nothing");
    }
  }
}

void FreeportBus::act(const Send& send) {
  ++counts_.exchanges;
  const Bytes answer = stations_.answer(to_stations_.pass(send.bytes));
  if (answer.empty()) return;
  arriving_ = to_master_.pass(answer);
  if (!arriving_.empty())
    arrives_ = now_ + kLine.characters(static_cast<double>(send.bytes.size() + answer.size())) +
               response_time_;
}

void FreeportBus::publish(const Sample& sample) {
  if (sample.quality != Quality::kGood) {
    ++counts_.bad;
    return;
  }
  const bool right = sample.value == Value{std::uint64_t{stations_.window(sample.channel + 1)}};
  ++(right ? counts_.right : counts_.wrong);
}

void FreeportBus::feed(const BusEvent& event) {
  actions_.clear();
  engine_.on_event(event, now_, actions_);
  make_plans(engine_, now_, actions_);
  for (const Action& action : actions_) {
    if (const auto* send = std::get_if<Send>(&action)) act(*send);
    if (const auto* set = std::get_if<SetTimer>(&action))
      timer_ = set->at == kNever ? kNever : std::max(set->at, now_);
    if (const auto* samples = std::get_if<Publish>(&action)) {
      for (const Sample& sample : samples->samples) publish(sample);
    }
  }
}

}  // namespace fieldcast::test
