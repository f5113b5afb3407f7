// Converts between the texts of scaled values ("12.50") and the numbers of their fields (1250 and
// 2 decimals), for the device. Pure functions.
#pragma once

#include "tools/sim/device/declared_text.hpp"

namespace fieldcast::sim {

// Replaces the texts of scaled values by what their fields, exponents and signs send. A value that
// its field cannot hold is sent as the largest one.
void texts_to_fields(const declared::Frame& frame, DeclaredText& text);
// Replaces what these fields have received by the texts of the values.
void fields_to_texts(const declared::Frame& frame, DeclaredText& text);

}  // namespace fieldcast::sim
