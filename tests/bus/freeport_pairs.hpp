// Errors that the XOR check of S7 freeport does not detect: two flipped bits in the same column of
// two characters that stay upper-case digits. Every pair of a frame is tried with UART and decoder.
// The shares below are therefore exact up to the square of the bit error rate; four flipped bits
// are a million times less frequent at 1e-4. A master cannot detect either kind of pair: data that
// match their check are a valid response, and responses do not identify their station. Stations
// that check the unused digits of a read request would detect most of the second kind.
#pragma once

#include <cstdint>

namespace fieldcast::test {

// Number of pairs of flipped bits in one exchange that produce a wrong value, averaged over random
// windows.
struct FreeportPairs {
  // In the response: pairs that every receiver must accept that checks marks, length, digits and
  // XOR.
  double check_allows = 0;
  double taken = 0;  // in the response: pairs that our decoder accepts
  // In the request: pairs after which another station responds, and its response is accepted.
  double misled = 0;
  std::uint64_t single = 0;  // single bits, in either direction: must be 0
};
[[nodiscard]] FreeportPairs count_freeport_pairs(unsigned stations, unsigned windows,
                                                 std::uint64_t seed);

// Share of exchanges that publish a wrong value, for this number of pairs.
[[nodiscard]] double wrong_share(double pairs, double bit_error_rate);

}  // namespace fieldcast::test
