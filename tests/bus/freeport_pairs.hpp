// Computes which errors the XOR check of S7 freeport does not detect: two flipped bits in the same
// column of two characters that stay upper-case hexadecimal digits.
//
// Every pair of bits of a frame is tried through UART and decoder. The shares are exact up to the
// square of the bit error rate; four flipped bits are a million times rarer at 1e-4. A master can
// detect neither pair: the data match the check, and a response does not name its request. Stations
// that check the unused digits of a read request would detect most pairs of the second kind.
#pragma once

#include <cstdint>

namespace fieldcast::test {

// Number of bit pairs of one exchange that give a wrong value, averaged over random windows.
struct FreeportPairs {
  double check_allows = 0;  // response pairs that no receiver can detect by marks,
                            // length, digits and XOR
  double taken = 0;         // response pairs that our decoder accepts
  double misled = 0;        // request pairs that select another station, whose response is accepted
                            // as that of the right one
  std::uint64_t single = 0;  // single bits, in either direction; must be 0
};
[[nodiscard]] FreeportPairs count_freeport_pairs(unsigned stations, unsigned windows,
                                                 std::uint64_t seed);

// Returns the share of exchanges that publish a wrong value.
[[nodiscard]] double wrong_share(double pairs, double bit_error_rate);

}  // namespace fieldcast::test
