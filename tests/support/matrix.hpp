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
  // Every flipped bit is detected (a checksum covers everything). Modbus TCP relies on TCP for
  // that.
  bool checked = true;
  // Characters before the first response do not prevent its reception.
  bool noise_recovers = true;
};

// Adds a gtest failure for each cell with another value than the undisturbed run, or with a value
// where none is allowed.
void expect_matrix(const MatrixCase& matrix);

// Feeds `rounds` random texts from one seed, some built from pieces of the responses. A crash, a
// hang or (if checked) another value than the undisturbed one is a failure.
void expect_random_bytes_are_refused(const MatrixCase& matrix, unsigned seed, int rounds);

}  // namespace fieldcast::test
