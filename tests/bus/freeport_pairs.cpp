#include "tests/bus/freeport_pairs.hpp"

#include <cmath>
#include <functional>
#include <string_view>

#include "core/protocol/families/registry.hpp"
#include "tests/bus/freeport_bus.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::test {
namespace {

constexpr std::size_t kDataBegin = 1, kCheckBegin = 9, kEnd = 11;  // of a response: q DU*8 FC FC Q
constexpr double kBitsOfExchange = 290;                            // 17 and 12 characters

const Request kRead = ReadRequest{{{0, 0, 4}}};

std::unique_ptr<Protocol> master_of(unsigned station) {
  return std::move(
      *find_protocol("s7-freeport")->make({.address = static_cast<std::uint16_t>(station)}));
}
Bytes request_of(const Protocol& master) {
  Bytes request;
  (void)master.begin(kRead, {})->start(request);
  return request;
}
// Returns whether the master accepts the response with a value that differs from `window`.
bool is_wrong(const Protocol& master, const Bytes& answer, std::uint32_t window) {
  if (answer.empty()) return false;
  const auto exchange = master.begin(kRead, {});
  const Outcome outcome = drive(*exchange, answer);
  return outcome.done() && read_u32(outcome.reply.at(0).items) != window;
}

// Calls `each` with the bytes that a UART receives for each single and each pair of flipped bits.
void flip_all(const Bytes& sent, const std::function<void(const Bytes&, bool two)>& each) {
  std::vector<bool> levels = line_levels(sent);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    levels[i].flip();
    each(uart_received(levels), false);
    for (std::size_t j = i + 1; j < levels.size(); ++j) {
      levels[j].flip();
      each(uart_received(levels), true);
      levels[j].flip();
    }
    levels[i].flip();
  }
}

// Counts the pairs that no receiver can detect: still digits, correct check, other data.
std::uint64_t unseen_pairs(const Bytes& answer) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  const auto digit = [&](std::uint8_t c) { return kDigits.find(static_cast<char>(c)); };
  const auto passes = [&](const Bytes& text) {
    unsigned check = 0;
    for (std::size_t i = kDataBegin; i < kEnd; ++i) {
      if (digit(text[i]) == std::string_view::npos) return false;
      if (i < kCheckBegin) check ^= text[i];
    }
    return check == digit(text[kCheckBegin]) * 16 + digit(text[kCheckBegin + 1]);
  };
  std::uint64_t pairs = 0;
  Bytes text = answer;
  const std::size_t first = 8 * kDataBegin, end = 8 * kEnd;
  const auto flip = [&](std::size_t bit) {
    text[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
  };
  for (std::size_t i = first; i < end; ++i) {
    for (std::size_t j = i + 1; j < end; ++j) {
      flip(i), flip(j);
      pairs += passes(text);  // two flipped bits of the check digits alone always fail
      flip(i), flip(j);
    }
  }
  return pairs;
}

}  // namespace

FreeportPairs count_freeport_pairs(unsigned stations, unsigned windows, std::uint64_t seed) {
  FreeportPairs pairs;
  FreeportStations plant(stations, seed);
  for (unsigned i = 0; i < windows; ++i) {
    const unsigned station = 1 + i % stations;
    const auto master = master_of(station);
    const Bytes answer = plant.answer(request_of(*master));
    pairs.check_allows += static_cast<double>(unseen_pairs(answer)) / windows;
    flip_all(answer, [&](const Bytes& received, bool two) {
      if (!is_wrong(*master, received, plant.window(station))) return;
      if (two)
        pairs.taken += 1.0 / windows;
      else
        ++pairs.single;
    });
  }
  for (unsigned station = 1; station <= stations; ++station) {
    const auto master = master_of(station);
    flip_all(request_of(*master), [&](const Bytes& received, bool two) {
      const Bytes answer = plant.answer(received);
      if (!is_wrong(*master, answer, plant.window(station))) return;
      if (two)
        pairs.misled += 1.0 / stations;
      else
        ++pairs.single;
    });
  }
  return pairs;
}

double wrong_share(double pairs, double bit_error_rate) {
  return pairs * std::pow(bit_error_rate, 2) * std::pow(1 - bit_error_rate, kBitsOfExchange - 2);
}

}  // namespace fieldcast::test
