// The test matrix for every decoder: all splits, all truncations, every single bit flipped, noise
// before. One call for a request and its responses.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "tests/support/drive.hpp"

namespace fieldcast::test {

struct MatrixCase {
  // Creates a new exchange for the same request at each call.
  std::function<std::unique_ptr<Exchange>()> begin;
  std::vector<Bytes> answers;  // one for each round
  // Every flipped bit is detected by a checksum. Modbus TCP leaves this to TCP.
  bool checked = true;
  // Characters before the first response do not prevent its reception.
  bool noise_recovers = true;
};

// A gtest failure for each cell with a value that the undisturbed run does not have.
void expect_matrix(const MatrixCase& matrix);

// Feeds `rounds` random texts from one seed, some built from pieces of the responses. A crash, a
// hang or (if checked) another value than the undisturbed one is a failure.
void expect_random_bytes_are_refused(const MatrixCase& matrix, unsigned seed, int rounds);

}  // namespace fieldcast::test
