// Samples as a WriteRequest of Prometheus Remote-Write 1.0. Pure.
#pragma once

#include <string>
#include <string_view>

#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

// The series fieldcast_value and fieldcast_sequence of each channel and quality. Texts have no
// series. The result of several batches may be joined: the series follow each other. Empty if
// nothing can be sent.
[[nodiscard]] std::string to_write_request(std::string_view site, const SampleBatch& batch,
                                           const DeviceCatalogue& catalogue);

// A block of snappy, which Prometheus requires.
[[nodiscard]] std::string snappy_block(const std::string& text);

}  // namespace fieldcast::forward
