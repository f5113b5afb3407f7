// What S7 freeport's XOR check lets through: two flipped bits in the same column of two characters,
// when the characters stay upper-case digits. Every pair of a frame is tried, through UART and
// decoder, so the shares below are exact up to the square of the bit error rate; four flipped bits
// come a million times more rarely at 1e-4. Neither pair can be seen by a master: data that agree
// with their check are an answer, and answers do not say whose they are. Stations that look at the
// unused digits of a read's request would see most of the second kind.
#pragma once

#include <cstdint>

namespace fieldcast::test {

// How many pairs of bits of one exchange yield a wrong value when both are flipped, on average over
// random windows.
struct FreeportPairs {
  double check_allows = 0;  // in the answer: pairs that any receiver must take that knows marks,
                            // length, digits and XOR
  double taken = 0;         // in the answer: those that our decoder takes
  double misled = 0;  // in the request: those that make another station answer, and its answer pass
                      // for the right one's
  std::uint64_t single = 0;  // single bits, in either: there must be none
};
[[nodiscard]] FreeportPairs count_freeport_pairs(unsigned stations, unsigned windows,
                                                 std::uint64_t seed);

// The share of exchanges that publish a wrong value, of so many pairs.
[[nodiscard]] double wrong_share(double pairs, double bit_error_rate);

}  // namespace fieldcast::test
