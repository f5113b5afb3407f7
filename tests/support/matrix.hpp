// The matrix that every decoder passes: all splits, all truncations, every single bit flipped,
// noise before. One call for a request and its answers.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "tests/support/drive.hpp"

namespace fieldcast::test {

struct MatrixCase {
  // A fresh exchange, each time for the same request.
  std::function<std::unique_ptr<Exchange>()> begin;
  std::vector<Bytes> answers;  // one for each round
  // A single flipped bit is always seen (a checksum covers everything). Modbus TCP leaves that to
  // TCP.
  bool checked = true;
  // Characters that stand before the first answer do not cost it.
  bool noise_recovers = true;
};

// Adds a gtest failure for each cell that yields another value than the undisturbed run, or a value
// where there must be none.
void expect_matrix(const MatrixCase& matrix);

// Feeds `rounds` random texts, some of them made from pieces of the answers, from one seed: a
// crash, a hang or (where checked) a value other than the undisturbed one is a failure.
void expect_random_bytes_are_refused(const MatrixCase& matrix, unsigned seed, int rounds);

}  // namespace fieldcast::test
